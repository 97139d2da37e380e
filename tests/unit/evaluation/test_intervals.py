"""Confidence intervals against known values and other ways to compute them."""

import math

import numpy as np
import pytest
from scipy.stats import norm
from sklearn.metrics import roc_auc_score

from preshape.evaluation.intervals import bootstrap_auc, wilson


@pytest.mark.parametrize(("successes", "n"), [(0, 10), (3, 10), (10, 10), (62, 100), (159, 1507)])
def test_wilson_agrees_with_its_formula(successes: int, n: int) -> None:
    z, rate = norm.ppf(0.975), successes / n
    centre = (rate + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * math.sqrt(rate * (1 - rate) / n + z**2 / (4 * n**2))
    assert wilson(successes, n) == pytest.approx((max(centre - half, 0), min(centre + half, 1)), abs=1e-12)


def test_wilson_of_a_textbook_case() -> None:
    assert wilson(10, 20) == pytest.approx((0.2993, 0.7007), abs=5e-5)


def test_nothing_tried_says_nothing() -> None:
    assert wilson(0, 0) == (0.0, 1.0)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_bootstrap_agrees_with_resampling_one_by_one(rng: np.random.Generator) -> None:
    labels = rng.random(120) < 0.3
    scores = np.round(labels + rng.normal(size=120), 1)  # rounded, so that there are ties
    draws = (rng.integers(0, 120, 120) for _ in range(500))
    aucs = [roc_auc_score(labels[draw], scores[draw]) for draw in draws]
    expected = tuple(np.quantile(aucs, [0.025, 0.975]))
    assert bootstrap_auc(labels, scores, rng, replicates=1500) == pytest.approx(expected, abs=0.025)


def test_repeating_every_trial_within_its_group_adds_no_certainty(rng: np.random.Generator) -> None:
    labels, groups = rng.random(80) < 0.4, np.arange(80)
    scores = labels + rng.normal(size=80)
    once = bootstrap_auc(labels, scores, np.random.default_rng(1), groups=groups)
    repeated = [np.tile(values, 4) for values in (labels, scores, groups)]
    grouped = bootstrap_auc(*repeated[:2], np.random.default_rng(1), groups=repeated[2])
    assert grouped == pytest.approx(once)
    low, high = bootstrap_auc(*repeated[:2], np.random.default_rng(1))
    assert high - low < 0.7 * (once[1] - once[0])


def test_perfect_order_has_no_spread(rng: np.random.Generator) -> None:
    labels = np.arange(30) % 3 == 0
    assert bootstrap_auc(labels, labels.astype(float), rng) == (1.0, 1.0)


def test_one_class_has_no_auc(rng: np.random.Generator) -> None:
    assert np.isnan(bootstrap_auc(np.ones(5, dtype=bool), rng.random(5), rng)).all()
