"""The small files of a finished fold, from which reports are made: figures, predictions, curves."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from preshape.errors import InputError
from preshape.evaluation.fold_summary import FoldResult
from preshape.evaluation.measured_files import (
    CURVES_FILE,
    METRICS_FILE,
    PREDICTIONS_FILE,
    read_figures,
    read_predictions,
)

FILES = (PREDICTIONS_FILE, CURVES_FILE, METRICS_FILE)
"""In the order in which they are written: a fold without its figures has not come to its end."""
ABOUT = ("experiment", "model", "trials", "trials_learned", "date", "split", "fold", "scalars", "identity")
"""What the figures of a fold say about it."""
OF_SUCCESS = ("auc", "average_precision", "brier", "ece", "accuracy", "f1")
"""Figures that every network has that predicts success."""
OF_GRASPS = ("palm_m", "palm_smallest_m", "orientation_rad", "joints_rad")
"""Figures that every network has that predicts grasps."""
BASELINES = ("random", "constant")
DECISIVE = ("settings", "data")
"""In what the folds of a group have to agree."""
LARGEST = 1e300


def read_fold(folder: Path) -> FoldResult:
    """Read a finished fold, and make sure that its files hold what reports need and belong together.

    Args:
        folder: its folder, called `<split>_fold<fold>`.

    Raises:
        InputError: naming the file that is missing, damaged, or not of this fold.
    """
    content = read_figures(folder / METRICS_FILE, *ABOUT)
    decisive_identity(content, folder / METRICS_FILE)
    if not (_is_about(content, folder.name) and _are_figures(content["scalars"])):
        raise _not_of_the_fold(f"These are not the figures of {folder.name}", folder / METRICS_FILE)
    predictions = read_predictions(folder / PREDICTIONS_FILE)
    if not _are_predictions(predictions, content["scalars"]):
        raise _not_of_the_fold("The predictions are not those of the figures", folder / PREDICTIONS_FILE)
    if not _are_points(read_figures(folder / CURVES_FILE, "points")["points"]):
        raise _not_of_the_fold("The file holds no curves", folder / CURVES_FILE)
    return FoldResult(folder, content)


def decisive_identity(content: Mapping[str, Any], where: Path) -> dict[str, str]:
    """Digests of settings and data, in which the folds of a group have to agree.

    Args:
        content: what a fold, or the summary of its group, says.
        where: the file that says it.

    Raises:
        InputError: if it does not say them.
    """
    identity = content.get("identity")
    if not isinstance(identity, dict) or not all(isinstance(identity.get(key), str) for key in DECISIVE):
        what = "The file does not say with which settings and data it was made"
        raise InputError(what, where=where, fix="start its sweep again")
    return {key: identity[key] for key in DECISIVE}


def _not_of_the_fold(what: str, where: Path) -> InputError:
    return InputError(what, where=where, fix="delete its folder and train the fold again")


def _is_about(content: Mapping[str, Any], name: str) -> bool:
    named = f"{content['split']}_fold{content['fold']}" == name
    return named and isinstance(content["fold"], int) and isinstance(content["date"], str)


def _are_figures(scalars: Any) -> bool:
    """Whether these are numbers, and all that are shown are among them, of each baseline all or none."""
    if not isinstance(scalars, dict) or not all(_is_number(value) for value in scalars.values()):
        return False
    wanted = OF_SUCCESS if "auc" in scalars else OF_GRASPS
    prefixes = ["", *(f"{name}_" for name in BASELINES if _has_any(scalars, f"{name}_"))]
    return isinstance(scalars.get("n"), int | float) and all(
        f"{prefix}{name}" in scalars for prefix in prefixes for name in wanted
    )


def _has_any(names: Collection[str], prefix: str) -> bool:
    return any(name.startswith(prefix) for name in names)


def _is_number(value: Any) -> bool:
    """Whether a value is a number that can be calculated with, or stands for one that is not known."""
    return value is None or (isinstance(value, int | float) and -LARGEST < value < LARGEST)


def _are_predictions(table: pd.DataFrame, scalars: Mapping[str, Any]) -> bool:
    """Whether these are predictions of the trials that the figures are about."""
    if len(table) != scalars["n"]:
        return False
    if "auc" not in scalars:
        return "theta_predicted" in table and _are_grasps(table["theta_predicted"])
    kinds = {name: dtype.kind for name, dtype in table.dtypes.items()}
    return (
        (kinds.get("lifted"), kinds.get("success_prob")) == ("b", "f")
        and bool(table["success_prob"].between(0.0, 1.0).all())
        and int(table["lifted"].sum()) == scalars.get("positives")
    )


def _are_grasps(column: pd.Series) -> bool:
    """Whether these are grasps of one space, each number known."""
    try:
        grasps = np.stack(column.to_list()).astype(float)
    except (TypeError, ValueError):
        return False
    return grasps.ndim == 2 and bool(np.isfinite(grasps).all())


def _are_points(points: Any) -> bool:
    return isinstance(points, list) and all(
        isinstance(point, dict) and "iteration" in point and all(map(_is_number, point.values()))
        for point in points
    )
