"""The receiver operating characteristic as a picture."""

from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure
from sklearn.metrics import roc_curve

from preshape.evaluation.metrics import ClassificationMetrics
from preshape.files import atomic_path


def save_roc(
    path: str | Path,
    labels: Bool[np.ndarray, "n"],
    success_prob: Float[np.ndarray, "n"],
    metrics: ClassificationMetrics,
) -> None:
    """Draw the ROC curve with its area and the decision threshold, atomically.

    Raises:
        InputError: if the place cannot be written to.
    """
    figure = Figure(figsize=(4.5, 4.5), layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color="0.6", linestyle=":", label="chance")
    if labels.any() and not labels.all():
        false_positives, true_positives, thresholds = roc_curve(labels, success_prob)
        area = f"AUC {metrics.auc:.2f} [{metrics.auc_low:.2f}, {metrics.auc_high:.2f}]"
        axes.plot(false_positives, true_positives, color="#0072B2", label=area)
        decided = np.searchsorted(-thresholds, -metrics.threshold, side="right") - 1
        axes.plot(
            false_positives[decided],
            true_positives[decided],
            "o",
            color="#D55E00",
            label=f"threshold {metrics.threshold:g}",
        )
    axes.set(
        xlabel="false positive rate",
        ylabel="true positive rate",
        title=f"{metrics.n} trials, {metrics.positives} lifted",
        aspect="equal",
        xlim=(-0.02, 1.02),
        ylim=(-0.02, 1.02),
    )
    axes.legend(loc="lower right")
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=150)
