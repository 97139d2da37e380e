"""Confidence intervals: Wilson for rates, bootstrap for areas under the ROC curve."""

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from scipy.stats import binomtest

CONFIDENCE = 0.95


def wilson(successes: int, n: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Wilson score interval (low, high) of a success rate; (0, 1) if nothing was tried."""
    if n == 0:
        return 0.0, 1.0
    interval = binomtest(successes, n).proportion_ci(confidence, method="wilson")
    return float(interval.low), float(interval.high)


def resampled(
    n: int, rng: np.random.Generator, *, groups: Int[np.ndarray, "n"] | None, replicates: int
) -> Float32[np.ndarray, "r n"]:
    """How often each of n trials occurs in each of r data sets that are drawn from them with replacement.

    Args:
        n: number of trials.
        rng: source of the draws.
        groups: scene of each trial; whole scenes are drawn. Without groups, single trials are.
        replicates: number r of data sets.
    """
    members = np.unique(np.arange(n) if groups is None else groups, return_inverse=True)[1]
    n_groups = int(members.max()) + 1
    drawn = rng.multinomial(n_groups, np.full(n_groups, 1 / n_groups), size=replicates)
    return drawn[:, members].astype(np.float32)


def bootstrap_auc(
    labels: Bool[np.ndarray, "n"],
    scores: Float[np.ndarray, "n"],
    rng: np.random.Generator,
    *,
    groups: Int[np.ndarray, "n"] | None = None,
    replicates: int = 2000,
    confidence: float = CONFIDENCE,
) -> tuple[float, float]:
    """Percentile bootstrap interval (low, high) of the area under the ROC curve.

    Args:
        labels, scores: outcome and predicted score (any monotone function of the probability) of each trial.
        rng: source of the resampling.
        groups: scene of each trial. Trials of one scene are alike, so whole scenes are resampled; without
            groups, single trials are.
        replicates: number of resampled data sets; those that miss one of the classes are left out.
        confidence: probability mass of the interval.

    Returns:
        (NaN, NaN) if the trials are all of one class.
    """
    if labels.all() or not labels.any():
        return float("nan"), float("nan")
    weights = resampled(len(labels), rng, groups=groups, replicates=replicates)
    return percentile_interval(resampled_aucs(labels, scores, weights), confidence)


def resampled_aucs(
    labels: Bool[np.ndarray, "n"], scores: Float[np.ndarray, "n"], weights: Float32[np.ndarray, "r n"]
) -> Float[np.ndarray, "r"]:
    """Area under the ROC curve in each resampled data set; NaN where it misses one of the classes.

    Args:
        labels, scores: see `bootstrap_auc`.
        weights: how often each trial occurs in each data set.
    """
    # AUC is the share of (positive, negative) pairs in the right order; resampling only weights the pairs.
    positive, negative = weights[:, labels], weights[:, ~labels]
    above = np.sign(scores[labels][:, None] - scores[~labels][None, :]).astype(np.float32) / 2 + 0.5
    ordered = ((positive @ above) * negative).sum(axis=1, dtype=np.float64)
    pairs = positive.sum(axis=1, dtype=np.float64) * negative.sum(axis=1, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        areas: Float[np.ndarray, "r"] = ordered / pairs
    return areas


def percentile_interval(
    values: Float[np.ndarray, "r"], confidence: float = CONFIDENCE
) -> tuple[float, float]:
    """The middle of what the resampled data sets gave (low, high); (NaN, NaN) if none gave a number."""
    known = values[np.isfinite(values)]
    if not len(known):
        return float("nan"), float("nan")
    tail = (1 - confidence) / 2
    low, high = np.quantile(known, [tail, 1 - tail])
    return float(low), float(high)
