"""The threshold of the best F1 is at least as good as every other."""

import numpy as np
import pytest

from preshape.evaluation.decisions import PAPER_THRESHOLD, best_f1_threshold, decision_metrics


def test_no_other_threshold_has_a_higher_f1() -> None:
    rng = np.random.default_rng(0)
    labels = rng.uniform(size=60) < 0.3
    probability = np.round(np.clip(0.3 * labels + rng.uniform(size=60) * 0.7, 0, 1), 2)
    best = decision_metrics(labels, probability, best_f1_threshold(labels, probability))
    others = [decision_metrics(labels, probability, threshold).f1 for threshold in np.linspace(0, 1, 101)]
    assert best.f1 == pytest.approx(max(others))
    assert best.f1 > decision_metrics(labels, probability, 0.9).f1


def test_the_threshold_lies_between_the_grasps_that_it_separates() -> None:
    labels = np.array([False, False, True, True])
    assert best_f1_threshold(labels, np.array([0.1, 0.2, 0.6, 0.9])) == pytest.approx(0.4)
    assert best_f1_threshold(np.ones(4, dtype=bool), np.array([0.1, 0.2, 0.6, 0.9])) == pytest.approx(0.05)


def test_without_successes_it_is_the_papers() -> None:
    assert best_f1_threshold(np.zeros(3, dtype=bool), np.array([0.1, 0.5, 0.9])) == PAPER_THRESHOLD
