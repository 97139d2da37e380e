"""What knows nothing about a grasp: the figures that a network has to beat."""

import numpy as np
from jaxtyping import Bool, Int

from preshape.evaluation.metrics import ClassificationMetrics, classification_metrics

COIN = 0.5
"""Threshold of the random baseline: the paper's chooses a label at 50 % probability (section 4.2)."""


def random_baseline(
    labels: Bool[np.ndarray, "n"], *, rng: np.random.Generator, groups: Int[np.ndarray, "n"] | None = None
) -> ClassificationMetrics:
    """Metrics of probabilities drawn evenly from 0 to 1, whatever the grasp.

    Args:
        labels: whether each trial lifted.
        rng: source of the probabilities and of the bootstrap's resampling.
        groups: scene of each trial, resampled as a whole.
    """
    drawn = rng.uniform(size=len(labels))
    return classification_metrics(labels, drawn, rng=rng, groups=groups, threshold=COIN)


def constant_baseline(
    labels: Bool[np.ndarray, "n"],
    train_labels: Bool[np.ndarray, "t"],
    *,
    rng: np.random.Generator,
    groups: Int[np.ndarray, "n"] | None = None,
) -> ClassificationMetrics:
    """Metrics of giving every grasp the share of successes among the training trials.

    Args:
        labels: whether each test trial lifted.
        train_labels: whether each training trial lifted.
        rng: source of the bootstrap's resampling.
        groups: scene of each test trial, resampled as a whole.
    """
    constant = np.full(len(labels), train_labels.mean())
    return classification_metrics(labels, constant, rng=rng, groups=groups)
