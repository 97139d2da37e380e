"""Classification metrics of cases whose figures are known."""

import math

import numpy as np
import pytest

from preshape.evaluation.metrics import ClassificationMetrics, classification_metrics


def metrics(labels: list[int], probabilities: list[float]) -> ClassificationMetrics:
    return classification_metrics(
        np.array(labels, dtype=bool), np.array(probabilities), rng=np.random.default_rng(0)
    )


def test_a_small_case_by_hand() -> None:
    found = metrics([1, 1, 0, 0, 0], [0.9, 0.3, 0.5, 0.2, 0.1])
    assert (found.n, found.positives) == (5, 2)
    assert found.auc == pytest.approx(5 / 6)  # one of six pairs is in the wrong order
    assert found.average_precision == pytest.approx((1 + 2 / 3) / 2)
    assert found.accuracy == pytest.approx(3 / 5)
    assert found.f1 == pytest.approx(2 * 1 / (2 * 1 + 1 + 1))
    assert found.brier == pytest.approx((0.01 + 0.49 + 0.25 + 0.04 + 0.01) / 5)
    assert found.auc_low <= found.auc <= found.auc_high


def test_calibration_error_is_the_gap_between_prediction_and_rate() -> None:
    assert metrics([1] * 7 + [0] * 3, [0.75] * 10).ece == pytest.approx(0.05, abs=1e-6)
    assert metrics([1] * 3 + [0] * 7, [0.75] * 10).ece == pytest.approx(0.45, abs=1e-6)


def test_always_failing_is_accurate_and_worthless() -> None:
    found = metrics([0] * 9 + [1], [0.1] * 10)
    assert found.accuracy == pytest.approx(0.9)
    assert found.auc == pytest.approx(0.5)
    assert found.f1 == 0.0


def test_one_class_leaves_the_auc_undefined() -> None:
    found = metrics([0, 0, 0], [0.1, 0.2, 0.3])
    assert math.isnan(found.auc)
    assert math.isnan(found.average_precision)
    assert found.accuracy == 1.0
    assert found.to_dict()["positives"] == 0
