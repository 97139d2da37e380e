"""ROC curves are averaged at the same false positive rate."""

import numpy as np
import pytest

from preshape.evaluation.average_roc import average_roc, average_roc_figure

PERFECT = (np.array([False, False, True, True]), np.array([0.1, 0.2, 0.8, 0.9]))
USELESS = (np.array([False, False, True, True]), np.full(4, 0.3))
ONE_CLASS = (np.array([False, False]), np.array([0.1, 0.2]))


def test_the_average_of_a_perfect_and_a_useless_fold() -> None:
    curve = average_roc([PERFECT, USELESS, ONE_CLASS])
    assert curve is not None
    assert curve.folds == 2
    inside = curve.false_positives > 0
    np.testing.assert_allclose(curve.mean[inside], (1 + curve.false_positives[inside]) / 2)
    np.testing.assert_allclose(curve.std[inside], (1 - curve.false_positives[inside]) / 2, atol=1e-12)
    assert curve.mean[0] == 0
    assert (curve.auc_mean, curve.auc_std) == pytest.approx((0.75, 0.25))


def test_the_area_below_the_average_is_the_average_area() -> None:
    rng = np.random.default_rng(0)
    folds = []
    for _ in range(5):
        scores = rng.uniform(size=400)
        folds.append((rng.uniform(size=400) < scores, scores))
    curve = average_roc(folds)
    assert curve is not None
    assert np.trapezoid(curve.mean, curve.false_positives) == pytest.approx(curve.auc_mean, abs=2e-3)
    legend = average_roc_figure({"seen": curve}, "title", {"seen": "paper 0.83"}).axes[0].get_legend()
    assert legend is not None
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts[0].startswith("seen: AUC 0.8")
    assert texts[0].endswith("5 folds (paper 0.83)")


def test_folds_without_a_curve_have_no_average() -> None:
    assert average_roc([ONE_CLASS]) is None
