"""What a training leaves of a fold can be reported and recorded."""

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
import torch
from synthetic_folds import ABOUT, IDENTITY, write_fold, write_grasp_fold
from synthetic_scenes import write_data_set
from tiny_training import SETTINGS, make_data, make_network

from analysis.learning.fold_files import read_fold
from analysis.learning.fold_record import FoldRecord
from preshape.errors import InputError
from preshape.evaluation.fold_summary import FoldResult
from preshape.files import read_json, write_json
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import GraspNetwork
from preshape.tracking.tracked_run import UntrackedRun
from preshape.training import train


def make_regression() -> RegressionCNN:
    torch.manual_seed(0)
    return RegressionCNN("regression", "allegro_palm14", 14)


@pytest.mark.parametrize("network", [make_network(), make_regression()], ids=lambda network: network.name)
def test_a_trained_fold_is_read_and_recorded(network: GraspNetwork, tmp_path: Path) -> None:
    write_data_set(tmp_path / "data", 15)
    folder = tmp_path / "train" / "seen_fold0"
    settings = replace(SETTINGS, learning=replace(SETTINGS.learning, iterations=6))
    about = {**ABOUT, "split": "seen", "fold": 0, "identity": IDENTITY}
    data = make_data(tmp_path / "data", validation_fraction=0.25)
    result = train(network, data, settings, folder, UntrackedRun(), about)

    record = FoldRecord(tmp_path / "record")
    record.take("tiny", [read_fold(folder)])
    (fold,) = record.folds("tiny")
    assert fold.scalars["n"] == result.metrics.n
    predictions = FoldResult(folder, {}).predictions()
    if predictions is None:
        assert fold.predictions() is None
    else:
        assert all(
            (own == theirs).all() for own, theirs in zip(fold.predictions() or (), predictions, strict=True)
        )


@pytest.mark.parametrize(
    "changes",
    [
        {"fold": 1},
        {"fold": "0"},
        {"split": "unseen"},
        {"date": None},
        {"scalars": []},
        {"scalars": {"n": 60}},
        {"scalars": {"n": 60, "auc": "high"}},
        {"identity": {"settings": "s"}},
        {"identity": []},
    ],
)
def test_figures_of_something_else_are_refused(tmp_path: Path, changes: dict[str, object]) -> None:
    path = tmp_path / "seen_fold0" / "metrics.json"
    write_fold(path.parent)
    write_json(path, {**read_json(path), **changes})
    with pytest.raises(InputError) as refusal:
        read_fold(path.parent)
    assert refusal.value.where == str(path)


@pytest.mark.parametrize("key", ["identity", "scalars", "date", "experiment"])
def test_figures_that_do_not_say_what_they_are_about_are_refused(tmp_path: Path, key: str) -> None:
    path = tmp_path / "seen_fold0" / "metrics.json"
    write_fold(path.parent)
    write_json(path, {name: value for name, value in read_json(path).items() if name != key})
    with pytest.raises(InputError, match=f"does not say {key}"):
        read_fold(path.parent)


@pytest.mark.parametrize(
    "grasps", [[3.0] * 60, [[0.0], [0.0, 1.0]] * 30, [["a"]] * 60, [[float("nan")]] * 60]
)
def test_what_are_no_grasps_is_refused(tmp_path: Path, grasps: list[object]) -> None:
    folder = tmp_path / "seen_fold0"
    write_grasp_fold(folder)
    pd.DataFrame({"theta_predicted": grasps}).to_parquet(folder / "predictions.parquet")
    with pytest.raises(InputError, match="predictions are not those"):
        read_fold(folder)
