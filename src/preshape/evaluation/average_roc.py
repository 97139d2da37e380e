"""The average of several ROC curves, as in the paper's figure of its cross validation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure
from sklearn.metrics import roc_auc_score, roc_curve

POINTS = 201
"""False positive rates at which curves are averaged, from 0 to 1."""
STYLES = (("#0072B2", "-"), ("#B24A00", "--"), ("#117733", "-."), ("0.3", ":"))
"""Colour and line of each curve of a picture."""
Fold = tuple[Bool[np.ndarray, "_"], Float[np.ndarray, "_"]]
"""Outcomes of a fold's test trials, and the success probabilities that were predicted for them."""


@dataclass(frozen=True, eq=False)
class AverageRoc:
    """ROC curves of several folds, averaged.

    Args:
        false_positives: rates at which the curves are averaged.
        mean, std: mean true positive rate of the folds there, and their standard deviation.
        auc_mean, auc_std: of the folds' areas.
        folds: number of folds.
    """

    false_positives: Float[np.ndarray, "k"]
    mean: Float[np.ndarray, "k"]
    std: Float[np.ndarray, "k"]
    auc_mean: float
    auc_std: float
    folds: int


def average_roc(folds: Sequence[Fold]) -> AverageRoc | None:
    """Average ROC curves vertically: the true positive rates at the same false positive rate.

    Args:
        folds: outcomes and predictions of each; folds with trials of one class alone have no curve.

    Returns:
        None if no fold has a curve.
    """
    folds = [(labels, scores) for labels, scores in folds if labels.any() and not labels.all()]
    if not folds:
        return None
    grid = np.linspace(0.0, 1.0, POINTS)
    curves = np.stack([np.interp(grid, *roc_curve(*fold)[:2]) for fold in folds])
    curves[:, 0] = 0.0  # where they begin, even if they are vertical there
    areas = np.array([roc_auc_score(*fold) for fold in folds])
    return AverageRoc(
        false_positives=grid,
        mean=curves.mean(axis=0),
        std=curves.std(axis=0),
        auc_mean=float(areas.mean()),
        auc_std=float(areas.std()),
        folds=len(folds),
    )


def average_roc_figure(
    curves: Mapping[str, AverageRoc], title: str, references: Mapping[str, str] | None = None
) -> Figure:
    """Average ROC curves with a band of one standard deviation, and that of chance.

    Args:
        curves: curves by their names.
        title: stands above.
        references: areas of others to compare with, as text by the names of the curves.
    """
    figure = Figure(figsize=(5.2, 5.2), layout="constrained")
    axes = figure.subplots()
    for (colour, line), (name, curve) in zip(STYLES, curves.items(), strict=False):
        deviation = f" ± {curve.auc_std:.3f}, {curve.folds} folds" if curve.folds > 1 else ", 1 fold"
        area = f"{name}: AUC {curve.auc_mean:.3f}{deviation}"
        beside = (references or {}).get(name)
        label = area if beside is None else f"{area} ({beside})"
        axes.plot(curve.false_positives, curve.mean, color=colour, linestyle=line, label=label)
        low, high = np.clip((curve.mean - curve.std, curve.mean + curve.std), 0.0, 1.0)
        axes.fill_between(curve.false_positives, low, high, color=colour, alpha=0.15, linewidth=0)
    axes.plot([0, 1], [0, 1], color="0.6", linestyle=":", label="chance: AUC 0.50")
    axes.set(
        xlabel="false positive rate",
        ylabel="true positive rate",
        title=title,
        aspect="equal",
        xlim=(-0.02, 1.02),
        ylim=(-0.02, 1.02),
    )
    axes.legend(loc="lower right", fontsize=8)
    return figure
