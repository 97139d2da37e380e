"""Baselines that know nothing have the figures that follow from the share of successes."""

import numpy as np
import pytest

from preshape.evaluation.baselines import constant_baseline, random_baseline

LABELS = np.arange(2000) % 10 == 0


def test_random_guesses_are_as_the_paper_has_them() -> None:
    found = random_baseline(LABELS, rng=np.random.default_rng(0), groups=np.arange(2000) // 100)
    assert found.auc == pytest.approx(0.5, abs=0.05)
    assert found.accuracy == pytest.approx(0.5, abs=0.05)
    assert found.f1 == pytest.approx(0.1 / 0.6, abs=0.03)  # precision 0.1, recall 0.5


def test_a_constant_is_calibrated_and_ranks_nothing() -> None:
    found = constant_baseline(LABELS, LABELS, rng=np.random.default_rng(0), groups=np.arange(2000) // 100)
    assert found.auc == 0.5
    assert found.average_precision == pytest.approx(0.1)
    assert found.brier == pytest.approx(0.1 * 0.9)
    assert found.ece == pytest.approx(0.0, abs=1e-9)
    assert (found.accuracy, found.f1) == (0.9, 0.0)
