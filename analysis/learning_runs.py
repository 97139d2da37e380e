"""Sweeps of `src/train.py` as they lie in their folders."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from analysis.roc_curves import stored_curve
from preshape.errors import InputError
from preshape.evaluation.fold_summary import (
    SUMMARY_FILE,
    FoldResult,
    by_split,
    finished_folds,
    split_figures,
    split_roc,
)
from preshape.files import read_json

SUCCESS_METRICS = {
    "auc": "auc",
    "ap": "average_precision",
    "brier": "brier",
    "ece": "ece",
    "accuracy": "accuracy",
    "f1": "f1",
    "accuracy_at_chosen_threshold": "accuracy_chosen",
    "f1_at_chosen_threshold": "f1_chosen",
    "temperature": "temperature",
    "brier_before_calibration": "brier_before_calibration",
    "ece_before_calibration": "ece_before_calibration",
}
"""Names in the result file, and in the files of the folds."""
GRASP_METRICS = {name: name for name in ("palm_m", "palm_smallest_m", "orientation_rad", "joints_rad")}
BASELINES = ("random", "constant")


@dataclass(frozen=True, eq=False)
class LearningRun:
    """The folds of one split of one group of a sweep.

    Args:
        group: name of the group: run and what else was chosen.
        split: how test trials were held out.
        folds: the folds that came to their end.
    """

    group: str
    split: str
    folds: Sequence[FoldResult]

    @property
    def about(self) -> Mapping[str, Any]:
        """What the first fold says about its training."""
        return self.folds[0].content

    @property
    def model(self) -> str:
        """Name of the network."""
        return str(self.about["model"])

    def figures(self) -> dict[str, Any]:
        """The run as it stands in the result file."""
        found = split_figures(self.folds)
        metrics = found["metrics"]
        names = SUCCESS_METRICS if "auc" in metrics else GRASP_METRICS
        return {
            **{key: self.about[key] for key in ("experiment", "model", "split", "trials", "trials_learned")},
            "group": self.group,
            **{key: found[key] for key in ("folds", "n", "positives")},
            **{name: metrics[key] for name, key in names.items() if key in metrics},
            "roc": stored_curve(split_roc(self.folds)),
            "baselines": {
                baseline: {
                    name: metrics[f"{baseline}_{key}"]
                    for name, key in names.items()
                    if f"{baseline}_{key}" in metrics
                }
                for baseline in BASELINES
                if any(key.startswith(f"{baseline}_") for key in metrics)
            },
        }

    def predictions(self) -> tuple[Bool[np.ndarray, "n"], Float[np.ndarray, "n"]]:
        """Outcomes and predicted probabilities of the test trials of all folds.

        Raises:
            InputError: if a table of predictions cannot be read.
        """
        found = [fold.predictions() for fold in self.folds]
        known = [fold for fold in found if fold is not None]
        labels, success_prob = zip(*known, strict=True)
        return np.concatenate(labels), np.concatenate(success_prob)


def read_runs(folder: str | Path) -> list[LearningRun]:
    """All runs of all sweeps below a folder, by name of their groups.

    Of each group only folds with the settings and data of its last summary are taken.

    Raises:
        InputError: if a file cannot be read, or there is no sweep.
    """
    runs = list(_runs(Path(folder)))
    if not runs:
        raise InputError(
            "There is no finished fold of a sweep",
            where=folder,
            fix="train with `python src/train.py --multirun split=seen,unseen fold=0,1,2,3,4`",
        )
    return runs


def _runs(folder: Path) -> Iterator[LearningRun]:
    for summary in sorted(folder.glob(f"*/{SUMMARY_FILE}")):
        identity = read_json(summary)["identity"]
        wanted = {key: identity[key] for key in ("settings", "data")}
        for split, folds in by_split(finished_folds(summary.parent, wanted)).items():
            yield LearningRun(summary.parent.name, split, folds)
