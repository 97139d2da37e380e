"""Bootstrap intervals of sums over trials."""

import numpy as np
import pytest
from sklearn.metrics import average_precision_score

from preshape.evaluation.metric_intervals import metric_intervals
from preshape.evaluation.metrics import classification_metrics


def test_intervals_hold_the_figures_and_shrink_with_the_trials() -> None:
    widths = []
    for n in (200, 3200):
        rng = np.random.default_rng(0)
        probability = np.round(rng.uniform(size=n), 2)  # with ties
        found = classification_metrics(rng.uniform(size=n) < probability, probability, rng=rng)
        for name in ("average_precision", "accuracy", "f1", "brier"):
            low, high = found.intervals[name]
            assert low < getattr(found, name) < high
        widths.append(found.intervals["brier"][1] - found.intervals["brier"][0])
    assert widths[0] / widths[1] == pytest.approx(4, rel=0.2)
    assert found.scalars()["ece_low"] == found.intervals["ece"][0]
    assert found.to_dict()["intervals"]["ap"] == list(found.intervals["average_precision"])


def test_one_scene_leaves_nothing_to_resample() -> None:
    labels, probability = np.array([True, False, True, False]), np.array([0.9, 0.6, 0.6, 0.1])
    found = metric_intervals(
        labels, probability, 0.5, np.random.default_rng(0), groups=np.zeros(4, dtype=int)
    )
    precision = average_precision_score(labels, probability)
    assert found["average_precision"] == pytest.approx((precision, precision))
    assert found["accuracy"] == (0.75, 0.75)
    assert found["f1"] == pytest.approx((0.8, 0.8))
    assert found["brier"] == pytest.approx((0.135, 0.135))


def test_nothing_lifted_has_no_precision() -> None:
    found = metric_intervals(np.zeros(5, dtype=bool), np.full(5, 0.2), 0.5, np.random.default_rng(0))
    assert np.isnan(found["average_precision"]).all()
    assert found["f1"] == (0.0, 0.0)
    assert found["accuracy"] == (1.0, 1.0)
