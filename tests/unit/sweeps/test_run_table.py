"""The table of a sweep: every run once, the best group first, wherever its jobs ran."""

from pathlib import Path

import pandas as pd
import pytest

from preshape.files import write_json
from preshape.sweeps.fold_table import FoldTable
from preshape.sweeps.run_table import join_table, sweep_folder

COMMAND = "python src/train.py --multirun model=config_cnn,regression split=seen fold=0,1"


def finish_run(runs: Path, group: str, fold: int, **scalars: float) -> Path:
    folder = runs / group / f"seen_fold{fold}"
    content = {"model": group, "split": "seen", "fold": fold, "scalars": {"n": 100, **scalars}}
    write_json(folder / "metrics.json", content)
    return folder


def test_the_best_group_comes_first_and_no_run_twice(tmp_path: Path) -> None:
    sweep = sweep_folder(tmp_path, COMMAND)
    for group, best in (("regression", {}), ("bad", {"auc": 0.5}), ("good", {"auc": 0.9})):
        for fold in (0, 1, 1):
            figures = {name: value - 0.1 * fold for name, value in best.items()}
            scalars = figures | {"brier": 0.2} if best else {"palm_m": 0.3}
            rows, table = join_table(sweep, finish_run(tmp_path, group, fold, **scalars), FoldTable())
    runs = pd.read_csv(rows)
    assert runs["group"].tolist() == ["good", "good", "bad", "bad", "regression", "regression"]
    assert runs["auc"].iloc[:4].tolist() == pytest.approx([0.9, 0.8, 0.5, 0.4])
    header, _, *lines = table.read_text().splitlines()
    assert "AUC" in header
    assert "ECE" not in header
    assert [line.split("|")[1].strip() for line in lines] == ["good", "bad", "regression"]
    assert "| 0.850 ± 0.050 |" in lines[0]


def test_the_folder_tells_sweeps_apart_but_not_how_they_are_run() -> None:
    folder = sweep_folder(Path(), COMMAND)
    assert folder.name == "fold=0,1_model=config_cnn,regression_split=seen"
    assert sweep_folder(Path(), f"{COMMAND} hydra/launcher=joblib hydra.launcher.n_jobs=2") == folder
    assert sweep_folder(Path(), f"{COMMAND} seed=1") != folder
    long = f"{COMMAND} {'x' * 100}="
    assert len(sweep_folder(Path(), f"{long}1").name) == 80
    assert sweep_folder(Path(), f"{long}1") != sweep_folder(Path(), f"{long}2")
