"""Comparing two planners on the same scenes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool
from scipy.stats import binomtest


@dataclass(frozen=True)
class PairedComparison:
    """Two planners on the same n scenes.

    Args:
        n: scenes.
        first_only, second_only: scenes on which only the one, or only the other, succeeded.
        difference: rate of the first less that of the second; NaN without scenes.
        p: two-sided probability of a split at least as uneven, were both equally good (exact McNemar test).
    """

    n: int
    first_only: int
    second_only: int
    difference: float
    p: float


def mcnemar(first: Bool[np.ndarray, "n"], second: Bool[np.ndarray, "n"]) -> PairedComparison:
    """Exact McNemar test: only scenes on which the two differ say which is better.

    Args:
        first, second: whether each planner succeeded on each scene.
    """
    n, first_only, second_only = len(first), int((first & ~second).sum()), int((~first & second).sum())
    differing = first_only + second_only
    p = float(binomtest(first_only, differing).pvalue) if differing else 1.0
    difference = (first_only - second_only) / n if n else float("nan")
    return PairedComparison(n, first_only, second_only, difference, p)
