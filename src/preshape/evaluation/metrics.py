"""How well predicted success probabilities tell grasps that lift from grasps that fail."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int
from sklearn.metrics import average_precision_score, brier_score_loss, roc_auc_score

from preshape.evaluation.calibration import reliability_diagram
from preshape.evaluation.decisions import PAPER_THRESHOLD, decision_metrics
from preshape.evaluation.intervals import bootstrap_auc
from preshape.evaluation.metric_intervals import metric_intervals

SHORT_NAMES = {"average_precision": "ap"}
"""Names of figures in result files, where they differ."""


@dataclass(frozen=True)
class ClassificationMetrics:
    """Figures of one test set.

    Args:
        n, positives: number of trials and of those that lifted.
        auc, auc_low, auc_high: area under the ROC curve with its 95 % bootstrap interval; NaN for one class.
        average_precision: area under the precision-recall curve; NaN without positives.
        accuracy, f1: at `threshold`.
        brier: mean squared error of the probability.
        ece: expected calibration error over ten bins of equal width.
        threshold: success probability above which success is predicted.
        intervals: 95 % bootstrap intervals (low, high) of the other figures, by their names.
    """

    n: int
    positives: int
    auc: float
    auc_low: float
    auc_high: float
    average_precision: float
    accuracy: float
    f1: float
    brier: float
    ece: float
    threshold: float
    intervals: Mapping[str, tuple[float, float]]

    def summary(self) -> str:
        """The most telling figures in words."""
        return (
            f"AUC {self.auc:.3f} [{self.auc_low:.3f}, {self.auc_high:.3f}] on {self.n} held-out trials, "
            f"{self.positives} of them lifted"
        )

    def scalars(self) -> dict[str, float]:
        """The figures and the ends of their intervals by their names, each a number."""
        figures = {name: float(value) for name, value in asdict(self).items() if name != "intervals"}
        for name, (low, high) in self.intervals.items():
            figures |= {f"{name}_low": low, f"{name}_high": high}
        return figures

    def to_dict(self) -> dict[str, Any]:
        """The figures as they stand in result files, the AUC with its interval as `{value, low, high}`."""
        return {
            "n": self.n,
            "positives": self.positives,
            "auc": {"value": self.auc, "low": self.auc_low, "high": self.auc_high},
            "ap": self.average_precision,
            "accuracy": self.accuracy,
            "f1": self.f1,
            "brier": self.brier,
            "ece": self.ece,
            "threshold": self.threshold,
            "intervals": {SHORT_NAMES.get(name, name): list(ends) for name, ends in self.intervals.items()},
        }


def classification_metrics(
    labels: Bool[np.ndarray, "n"],
    success_prob: Float[np.ndarray, "n"],
    *,
    rng: np.random.Generator,
    groups: Int[np.ndarray, "n"] | None = None,
    threshold: float = PAPER_THRESHOLD,
) -> ClassificationMetrics:
    """Metrics of predicted success probabilities against outcomes.

    Args:
        labels: whether each trial lifted.
        success_prob: predicted probability of it.
        rng: source of the bootstrap's resampling.
        groups: scene of each trial, resampled as a whole.
        threshold: success probability above which success is predicted.
    """
    both_classes = bool(labels.any() and not labels.all())
    low, high = bootstrap_auc(labels, success_prob, rng, groups=groups)
    decisions = decision_metrics(labels, success_prob, threshold)
    return ClassificationMetrics(
        n=len(labels),
        positives=int(labels.sum()),
        auc=float(roc_auc_score(labels, success_prob)) if both_classes else math.nan,
        auc_low=low,
        auc_high=high,
        average_precision=float(average_precision_score(labels, success_prob))
        if labels.any()
        else float("nan"),
        accuracy=decisions.accuracy,
        f1=decisions.f1,
        brier=float(brier_score_loss(labels, success_prob, pos_label=True)),
        ece=reliability_diagram(labels, success_prob).expected_error,
        threshold=threshold,
        intervals=metric_intervals(labels, success_prob, threshold, rng, groups=groups),
    )
