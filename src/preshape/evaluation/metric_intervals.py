"""Bootstrap intervals of figures that are sums over trials, for all resampled data sets at once."""

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from preshape.evaluation.calibration import bin_numbers
from preshape.evaluation.intervals import percentile_interval, resampled

REPLICATES = 1000


def metric_intervals(
    labels: Bool[np.ndarray, "n"],
    success_prob: Float[np.ndarray, "n"],
    threshold: float,
    rng: np.random.Generator,
    *,
    groups: Int[np.ndarray, "n"] | None = None,
) -> dict[str, tuple[float, float]]:
    """95 % percentile bootstrap intervals (low, high) of all figures but the AUC.

    Args:
        labels: whether each trial lifted.
        success_prob: predicted probability of it.
        threshold: probability above which success is predicted.
        rng: source of the resampling.
        groups: scene of each trial, resampled as a whole.

    Returns:
        Intervals by the metric's name; (NaN, NaN) where no resampled data set has a positive to rank.
    """
    weights = resampled(len(labels), rng, groups=groups, replicates=REPLICATES)
    total = weights.sum(axis=1)
    decided = success_prob > threshold
    hits = weights @ (decided & labels).astype(np.float32)
    claims = weights @ (decided.astype(np.float32) + labels)
    replicates = {
        "average_precision": _average_precisions(labels, success_prob, weights),
        "accuracy": weights @ (decided == labels).astype(np.float32) / total,
        "f1": np.divide(2 * hits, claims, out=np.zeros_like(hits), where=claims > 0),
        "brier": weights @ ((success_prob - labels) ** 2).astype(np.float32) / total,
        "ece": _calibration_errors(labels, success_prob, weights),
    }
    return {name: percentile_interval(values) for name, values in replicates.items()}


def _average_precisions(
    labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"], weights: Float32[np.ndarray, "r n"]
) -> Float[np.ndarray, "r"]:
    """Average precision in each resampled data set; equal probabilities are accepted together."""
    order = np.argsort(-success_prob, kind="stable")
    ranked = success_prob[order]
    last = np.flatnonzero(np.append(ranked[1:] != ranked[:-1], True))
    accepted = weights[:, order].cumsum(axis=1, dtype=np.float64)[:, last]
    hits = (weights[:, order] * labels[order]).cumsum(axis=1, dtype=np.float64)[:, last]
    precision = hits / np.maximum(accepted, 1.0)
    found = (np.diff(hits, axis=1, prepend=0.0) * precision).sum(axis=1)
    with np.errstate(invalid="ignore"):
        averages: Float[np.ndarray, "r"] = found / hits[:, -1]
    return averages


def _calibration_errors(
    labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"], weights: Float32[np.ndarray, "r n"]
) -> Float[np.ndarray, "r"]:
    """Expected calibration error in each resampled data set."""
    bins = bin_numbers(success_prob)
    gaps = (success_prob - labels)[:, None] * (bins[:, None] == np.unique(bins))
    distance = np.abs(weights @ gaps.astype(np.float32)).sum(axis=1)
    errors: Float[np.ndarray, "r"] = distance / weights.sum(axis=1)
    return errors
