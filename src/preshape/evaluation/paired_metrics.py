"""Comparing two networks on the same trials."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from preshape.evaluation.decisions import PAPER_THRESHOLD
from preshape.evaluation.intervals import percentile_interval, resampled, resampled_aucs

REPLICATES = 1000


@dataclass(frozen=True, eq=False)
class PairedFold:
    """What two networks say of the n test trials of a fold.

    Args:
        lifted: whether each trial lifted.
        first, second: success probabilities that the one and the other network predict.
        scenes: scene of each trial.
    """

    lifted: Bool[np.ndarray, "n"]
    first: Float[np.ndarray, "n"]
    second: Float[np.ndarray, "n"]
    scenes: Int[np.ndarray, "n"]


@dataclass(frozen=True)
class Difference:
    """A figure of the first network less that of the second.

    Args:
        value: mean over the folds; NaN if a fold does not have the figure.
        low, high: 95 % bootstrap interval.
    """

    value: float
    low: float
    high: float

    @property
    def known(self) -> bool:
        """Whether there is a number."""
        return math.isfinite(self.value) and math.isfinite(self.low)

    def to_dict(self) -> dict[str, Any]:
        """As it stands in result files."""
        return asdict(self)


def paired_differences(
    folds: Sequence[PairedFold], rng: np.random.Generator, *, threshold: float = PAPER_THRESHOLD
) -> Mapping[str, Difference]:
    """AUC, Brier score and accuracy of the first networks less those of the second, mean over the folds.

    Both see the same resampled scenes, so what is hard for both does not widen the intervals. They say how
    sure a difference is on other scenes alike; another training of the same network is not in them.

    Args:
        folds: at least one; each has networks of its own.
        rng: source of the resampling; whole scenes are drawn.
        threshold: success probability above which success is predicted.

    Returns:
        Differences by `auc`, `brier` and `accuracy`.
    """
    once, drawn = [], []
    for fold in folds:
        weights = resampled(len(fold.lifted), rng, groups=fold.scenes, replicates=REPLICATES)
        once.append(_differences(fold, np.ones((1, len(fold.lifted)), np.float32), threshold))
        drawn.append(_differences(fold, weights, threshold))
    return {
        name: Difference(
            float(np.mean([values[name] for values in once])),
            *percentile_interval(np.mean([values[name] for values in drawn], axis=0)),
        )
        for name in once[0]
    }


def _differences(
    fold: PairedFold, weights: Float32[np.ndarray, "r n"], threshold: float
) -> dict[str, Float[np.ndarray, "r"]]:
    """Differences in each of r data sets, in which each trial occurs so often."""
    first, second = (_figures(fold.lifted, prob, weights, threshold) for prob in (fold.first, fold.second))
    return {name: first[name] - second[name] for name in first}


def _figures(
    lifted: Bool[np.ndarray, "n"],
    success_prob: Float[np.ndarray, "n"],
    weights: Float32[np.ndarray, "r n"],
    threshold: float,
) -> dict[str, Float[np.ndarray, "r"]]:
    total = weights.sum(axis=1, dtype=np.float64)
    errors, right = (success_prob - lifted) ** 2, (success_prob > threshold) == lifted
    return {
        "auc": resampled_aucs(lifted, success_prob, weights),
        "brier": weights @ errors / total,
        "accuracy": weights @ right.astype(np.float64) / total,
    }
