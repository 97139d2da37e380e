"""Sweeps of `src/train.py` as they lie in their folders."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from analysis.learning.fold_files import BASELINES, OF_GRASPS, decisive_identity, read_fold
from analysis.learning.fold_record import FoldRecord
from analysis.learning.roc_curves import stored_curve
from preshape.errors import InputError
from preshape.evaluation.fold_summary import (
    SUMMARY_FILE,
    FoldResult,
    by_split,
    finished_folds,
    split_figures,
    split_roc,
)
from preshape.evaluation.measured_files import PREDICTIONS_FILE, read_figures, read_predictions

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
GRASP_METRICS = {name: name for name in OF_GRASPS}
SAME_GRASP = 1e-4
"""Grasps are one and the same if no parameter spreads more (m or rad)."""


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

    @property
    def numbers(self) -> set[int]:
        """Numbers of the folds."""
        return {fold.content["fold"] for fold in self.folds}

    def of_folds(self, numbers: Collection[int]) -> "LearningRun":
        """The same run with some of its folds alone."""
        folds = [fold for fold in self.folds if fold.content["fold"] in numbers]
        return replace(self, folds=folds)

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

    def collapsed_folds(self) -> list[int]:
        """Folds whose network, which predicts grasps, says the same one whatever it sees.

        Raises:
            InputError: if a table of predictions cannot be read.
        """
        return [fold.content["fold"] for fold in self.folds if _spread(fold) < SAME_GRASP]


def _spread(fold: FoldResult) -> float:
    """Largest standard deviation of a parameter among the predicted grasps (m or rad)."""
    grasps = np.stack(read_predictions(fold.folder / PREDICTIONS_FILE)["theta_predicted"].to_list())
    return float(grasps.std(axis=0).max())


def measured_folds(folder: str | Path, groups: Collection[str]) -> dict[str, list[FoldResult]]:
    """The finished folds of sweeps by their groups; only those with settings and data of the last summary.

    Args:
        folder: folder of the groups, as `src/train.py --multirun` makes it; it may be missing.
        groups: names of those that are read.

    Raises:
        InputError: if a file is missing, damaged, or not of its fold.
    """
    summaries = sorted(Path(folder).glob(f"*/{SUMMARY_FILE}"))
    found = {path.parent.name: _summarised(path) for path in summaries if path.parent.name in groups}
    return {group: folds for group, folds in found.items() if folds}


def _summarised(summary: Path) -> list[FoldResult]:
    identity = decisive_identity(read_figures(summary, "identity"), summary)
    return [read_fold(fold.folder) for fold in finished_folds(summary.parent, identity)]


def read_runs(record: FoldRecord, groups: Collection[str]) -> list[LearningRun]:
    """The recorded runs of some groups, by the names of the groups.

    Raises:
        InputError: if a file is missing, damaged, or not of its fold, or there is no fold.
    """
    runs = [
        LearningRun(group, split, _with_shared_figures(folds))
        for group in record.groups()
        if group in groups
        for split, folds in by_split(record.folds(group)).items()
    ]
    if not runs:
        raise InputError(
            "There is no finished fold of a sweep",
            where=record.folder,
            fix="train with `python src/train.py --multirun split=seen,unseen fold=0,1,2,3,4`",
        )
    return runs


def _with_shared_figures(folds: Sequence[FoldResult]) -> list[FoldResult]:
    """The folds without figures that not all of them have, since code that came later measures more."""
    shared = set.intersection(*(set(fold.content["scalars"]) for fold in folds))
    return [
        replace(fold, content={**fold.content, "scalars": _chosen(fold.content["scalars"], shared)})
        for fold in folds
    ]


def _chosen(scalars: Mapping[str, float], names: Collection[str]) -> dict[str, float]:
    return {name: value for name, value in scalars.items() if name in names}
