"""The curves that DVC draws."""

from pathlib import Path

import pandas as pd
import pytest

from analysis.learning.curve_tables import CurveTables
from preshape.errors import InputError
from preshape.files import read_json, write_json


def write_run(folder: Path) -> None:
    """A training and an evaluation with made-up figures."""
    scalars = dict.fromkeys(("auc", "auc_low", "auc_high", "average_precision", "brier", "ece"), 0.75)
    bins = {"count": [3, 0, 1], "predicted": [0.1, None, 0.9], "observed": [0.0, None, 1.0]}
    diagram = {**bins, "low": [0.0, 0.0, 0.2], "high": [0.6, 1.0, 1.0]}
    write_json(folder / "metrics.json", {"scalars": scalars, "reliability": diagram})
    write_json(folder / "curves.json", {"points": [{"iteration": 10, "val_loss": 0.5}]})
    outcomes = {"lifted": [False, False, True, True], "success_prob": [0.1, 0.6, 0.5, 0.9]}
    pd.DataFrame(outcomes).to_parquet(folder / "predictions.parquet")
    write_json(folder / "evaluation.json", {"planners": {"inference": {"rate": 0.8}}})


def test_curves_and_figures_are_those_of_the_run(tmp_path: Path) -> None:
    write_run(tmp_path)
    CurveTables(tmp_path, tmp_path, tmp_path / "out").write()
    roc = pd.read_csv(tmp_path / "out" / "roc.csv").to_numpy()
    assert roc[0].tolist() == [0, 0]
    assert roc[-1].tolist() == [1, 1]
    area = ((roc[1:, 0] - roc[:-1, 0]) * (roc[1:, 1] + roc[:-1, 1]) / 2).sum()
    assert area == pytest.approx(0.75)  # of four pairs, three are in order
    assert pd.read_csv(tmp_path / "out" / "reliability.csv")["predicted"].tolist() == [0.1, 0.9]
    figures = read_json(tmp_path / "out" / "figures.json")
    assert (figures["auc"], figures["lifted"]) == (0.75, {"inference": 0.8})


def test_a_network_that_predicts_grasps_is_refused(tmp_path: Path) -> None:
    write_json(tmp_path / "metrics.json", {"scalars": {}})
    with pytest.raises(InputError, match="does not predict success"):
        CurveTables(tmp_path, tmp_path, tmp_path).write()
