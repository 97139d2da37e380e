"""The report about learning shows what was run, and says what was not."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.learning_report import LearningReport
from preshape.errors import InputError
from preshape.evaluation.baselines import random_baseline
from preshape.evaluation.fold_summary import summarise
from preshape.evaluation.metrics import classification_metrics
from preshape.files import read_json, write_json
from preshape.measuring import Measurement

IDENTITY = {"settings": "s", "data": "d", "code": "c"}


def write_fold(group: Path, split: str, fold: int, trials_learned: int | None = None) -> float:
    """A fold as a training leaves it; returns its AUC."""
    rng = np.random.default_rng(fold)
    success_prob = rng.uniform(size=60)
    labels = rng.uniform(size=60) < success_prob
    metrics = classification_metrics(labels, success_prob, rng=rng)
    measured = Measurement(metrics, {"random": random_baseline(labels, rng=rng)}, {}, {})
    folder = group / f"{split}_fold{fold}"
    folder.mkdir(parents=True)
    pd.DataFrame({"lifted": labels, "success_prob": success_prob}).to_parquet(folder / "predictions.parquet")
    write_json(folder / "curves.json", {"points": [{"iteration": i, "train_loss": 1 / i} for i in (1, 2)]})
    about = {"experiment": "paper", "split": split, "fold": fold, "seed": 0, "model": "config_cnn"}
    sizes = {"trials": None, "trials_learned": trials_learned, "identity": IDENTITY}
    write_json(
        folder / "metrics.json", {**about, **sizes, **measured.to_dict(), "scalars": measured.scalars()}
    )
    summarise(group, IDENTITY)
    return metrics.auc


def report(folder: Path) -> LearningReport:
    return LearningReport(
        runs=str(folder / "train"),
        paper={"config_cnn": "paper", "patches_cnn": "patches", "regression": "regression"},
        default="best",
        ablations={"Patches": {"fixed": "paper", "moving": "moving"}},
        calibrated=["paper"],
        learning_curves={"config-CNN": {"all": "paper", "fewer": "curve"}},
        output=str(folder / "cross_validation.json"),
        page=str(folder / "results.md"),
        seed=0,
    )


def test_what_was_run_stands_beside_the_paper_and_what_was_not_is_named(tmp_path: Path) -> None:
    areas = [write_fold(tmp_path / "train" / "paper", "unseen", fold) for fold in (0, 1)]
    write_fold(tmp_path / "train" / "curve,trials_learned=150", "unseen", 0, 150)
    assert "2 runs" in report(tmp_path).write()

    content = read_json(tmp_path / "cross_validation.json")
    assert list(content)[:5] == ["command", "git_revision", "versions", "seed", "date"]
    (run,) = (run for run in content["runs"] if run["group"] == "paper")
    assert (run["experiment"], run["model"], run["split"], run["n"]) == ("paper", "config_cnn", "unseen", 120)
    assert run["auc"]["folds"] == areas
    assert run["auc"]["mean"] == pytest.approx(np.mean(areas))
    assert {"positives", "ap", "brier", "ece", "accuracy", "f1"} <= set(run)

    page = (tmp_path / "results.md").read_text()
    (ours,) = (
        line for line in page.splitlines() if line.startswith("| config-CNN, as in the paper | unseen")
    )
    assert f"{np.mean(areas):.3f} ± {np.std(areas):.3f}" in ours
    assert "| paper, config-CNN | unseen | 5 | 1,507 | 159 | 0.82 ± 0.06 |" in page
    for missing in ("| default model | seen |", "| patches-CNN, as in the paper | unseen |", "| moving |"):
        (line,) = (line for line in page.splitlines() if line.startswith(missing))
        assert "*not run*" in line
    pictures = {path.name for path in (tmp_path / "pictures").iterdir()}
    shown = ("learning_curves", "reliability", "roc_config_cnn", "training_curves")
    assert pictures == {f"learning_{name}.png" for name in shown}
    assert all(name in page for name in pictures)


def test_no_sweep_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no finished fold"):
        report(tmp_path).write()
