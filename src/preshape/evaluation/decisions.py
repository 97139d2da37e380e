"""Yes or no: accuracy and F1 of predicted success at a threshold, and the choice of that threshold."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from sklearn.metrics import accuracy_score, f1_score, precision_recall_curve

PAPER_THRESHOLD = 0.4
"""Success probability above which a grasp counts as predicted to succeed (paper, section 4.2)."""


@dataclass(frozen=True)
class DecisionMetrics:
    """Figures of the decision that grasps above a success probability succeed.

    Args:
        threshold: that probability.
        accuracy: share of the decisions that are right.
        f1: harmonic mean of precision and recall of success; 0 where there is none.
    """

    threshold: float
    accuracy: float
    f1: float


def decision_metrics(
    labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"], threshold: float = PAPER_THRESHOLD
) -> DecisionMetrics:
    """Accuracy and F1 of deciding at a threshold."""
    decided = success_prob > threshold
    return DecisionMetrics(
        threshold=threshold,
        accuracy=float(accuracy_score(labels, decided)),
        f1=float(f1_score(labels, decided, zero_division=0.0)),
    )


def best_f1_threshold(labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"]) -> float:
    """Threshold of the highest F1, halfway to the next lower probability; the paper's if nothing lifted.

    To be chosen on validation trials, and judged on others.
    """
    if not labels.any():
        return PAPER_THRESHOLD
    precision, recall, lowest_accepted = precision_recall_curve(labels, success_prob)
    f1 = 2 * precision * recall / np.maximum(precision + recall, np.finfo(float).tiny)
    best = int(f1[:-1].argmax())
    below = lowest_accepted[best - 1] if best else 0.0
    return float((lowest_accepted[best] + below) / 2)
