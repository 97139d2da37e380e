"""Average ROC curves as they stand in result files."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from preshape.evaluation.average_roc import AverageRoc

EVERY = 2
"""Of the points at which curves are averaged, every second is kept: one for each 1 % of false positives."""
DIGITS = 4


def stored_curve(curve: AverageRoc | None) -> dict[str, Any] | None:
    """A curve as plain numbers; None for networks that predict no success."""
    if curve is None:
        return None
    names = ("false_positives", "mean", "std")
    points = {name: np.round(getattr(curve, name)[::EVERY], DIGITS).tolist() for name in names}
    return {**points, "auc_mean": curve.auc_mean, "auc_std": curve.auc_std, "folds": curve.folds}


def read_curve(stored: Mapping[str, Any]) -> AverageRoc:
    """The curve again."""
    names = ("false_positives", "mean", "std")
    points = {name: np.array(stored[name], dtype=float) for name in names}
    return AverageRoc(**points, auc_mean=stored["auc_mean"], auc_std=stored["auc_std"], folds=stored["folds"])
