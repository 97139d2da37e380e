"""Do grasps that are given a probability succeed that often? Reliability diagram and temperature scaling."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import minimize_scalar
from scipy.special import logit
from scipy.stats import hypergeom

from preshape.evaluation.intervals import wilson

CALIBRATION_BINS = 10
MAX_TEMPERATURE = 20.0
"""Temperatures are looked for between this and its inverse: separable trials would ask for 0."""


@dataclass(frozen=True, eq=False)
class ReliabilityDiagram:
    """Predicted probability against observed rate of success, in k bins of equal width.

    Args:
        count: trials in each bin.
        predicted: their mean predicted probability; NaN in an empty bin.
        observed: the share of them that lifted; NaN in an empty bin.
        low, high: 95 % Wilson interval of that share.
    """

    count: Int[np.ndarray, "k"]
    predicted: Float[np.ndarray, "k"]
    observed: Float[np.ndarray, "k"]
    low: Float[np.ndarray, "k"]
    high: Float[np.ndarray, "k"]

    @property
    def expected_error(self) -> float:
        """Expected calibration error: the mean distance of both over all trials."""
        filled = self.count > 0
        distance = np.abs(self.predicted - self.observed)[filled]
        return float(np.average(distance, weights=self.count[filled]))

    def to_dict(self) -> dict[str, Any]:
        """The bins as they stand in result files."""
        names = ("count", "predicted", "observed", "low", "high")
        return {name: getattr(self, name).tolist() for name in names}


def reliability_diagram(
    labels: Bool[np.ndarray, "n"], success_prob: Float[np.ndarray, "n"], bins: int = CALIBRATION_BINS
) -> ReliabilityDiagram:
    """Sort trials into bins of predicted probability.

    Args:
        labels: whether each trial lifted.
        success_prob: predicted probability of it.
        bins: number k of bins between 0 and 1.
    """
    bin_of = bin_numbers(success_prob, bins)
    count = np.bincount(bin_of, minlength=bins)
    lifted = np.bincount(bin_of, weights=labels, minlength=bins)
    total = np.bincount(bin_of, weights=success_prob, minlength=bins)
    with np.errstate(invalid="ignore"):
        predicted, observed = total / count, lifted / count
    intervals = [wilson(int(k), int(n)) for k, n in zip(lifted, count, strict=True)]
    low, high = np.array(intervals).T
    return ReliabilityDiagram(count, predicted, observed, low, high)


def bin_numbers(success_prob: Float[np.ndarray, "n"], bins: int = CALIBRATION_BINS) -> Int[np.ndarray, "n"]:
    """Number of the bin that each probability falls into, of so many of equal width."""
    numbers: Int[np.ndarray, "n"] = np.digitize(success_prob, np.linspace(0.0, 1.0, bins + 1)[1:-1])
    return numbers


def oversampling_shift(n: int, positives: int, *, batch_size: int, min_positives: int) -> float:
    """By how much to move logits that were learned from oversampled successes (prior correction).

    Batches that are drawn again until they hold enough successes have a greater share of them than the table.
    Of each class they are fair samples, so a network trained on them is off by the difference of the two log
    odds.

    Args:
        n, positives: trials learned from, and those of them that lifted.
        batch_size: trials per batch, drawn without replacement.
        min_positives: lifted trials that a batch has at least.

    Returns:
        What to add to a logit: 0 or less; 0 if one of the classes is missing.
    """
    counts = np.arange(min_positives, batch_size + 1)
    probability = hypergeom.pmf(counts, n, positives, batch_size)
    drawn = float((counts * probability).sum() / probability.sum()) / batch_size
    if not 0 < positives < n or drawn >= 1:
        return 0.0
    return float(logit(positives / n) - logit(drawn))


def fit_temperature(labels: Bool[np.ndarray, "n"], logits: Float[np.ndarray, "n"]) -> float:
    """Temperature T for which sigmoid(logit / T) has the lowest cross entropy (temperature scaling).

    To be fitted to validation trials. It leaves the order of the grasps as it is.

    Args:
        labels: whether each trial lifted.
        logits: predicted log odds of it.
    """
    signed = np.where(labels, logits, -logits)

    def cross_entropy(log_temperature: float) -> float:
        return float(np.logaddexp(0.0, -signed * np.exp(-log_temperature)).mean())

    limit = np.log(MAX_TEMPERATURE)
    best = minimize_scalar(cross_entropy, bounds=(-limit, limit), method="bounded")
    return float(np.exp(best.x))
