"""McNemar's test on tables whose answer is known, and probabilities corrected by other trials."""

import numpy as np
import pytest

from preshape.evaluation.paired import mcnemar
from preshape.evaluation.recalibration import cross_fitted, isotonic_regression, temperature_scaling


def pairs(both: int, first: int, second: int, neither: int) -> tuple[np.ndarray, np.ndarray]:
    counts = (both, first, second, neither)
    return np.repeat([True, True, False, False], counts), np.repeat([True, False, True, False], counts)


@pytest.mark.parametrize(
    ("table", "p"),
    [
        ((50, 0, 0, 50), 1.0),
        ((3, 1, 0, 3), 1.0),
        ((0, 6, 0, 0), 2 / 2**6),
        ((9, 8, 1, 2), 2 * (1 + 9) / 2**9),
        ((5, 4, 4, 7), 1.0),
    ],
)
def test_only_scenes_on_which_planners_differ_count(table: tuple[int, int, int, int], p: float) -> None:
    first, second = pairs(*table)
    compared = mcnemar(first, second)
    assert compared.p == pytest.approx(p)
    assert (compared.n, compared.first_only, compared.second_only) == (sum(table), table[1], table[2])
    assert compared.difference == pytest.approx(first.mean() - second.mean())
    other = mcnemar(second, first)
    assert (other.p, other.difference) == (compared.p, -compared.difference)


def test_without_scenes_nothing_is_known() -> None:
    nothing = mcnemar(np.zeros(0, dtype=bool), np.zeros(0, dtype=bool))
    assert nothing.n == 0
    assert nothing.p == 1.0
    assert np.isnan(nothing.difference)


@pytest.mark.parametrize("fit", [temperature_scaling, isotonic_regression])
def test_an_overconfident_network_is_corrected(fit: object) -> None:
    rng = np.random.default_rng(0)
    log_odds = rng.normal(0.5, 1.0, 4000)
    labels = rng.random(4000) < 1 / (1 + np.exp(-log_odds))
    said = 1 / (1 + np.exp(-4 * log_odds))
    half = np.arange(4000) % 2 == 0
    corrected = cross_fitted(fit, labels, said, half)
    truth = 1 / (1 + np.exp(-log_odds))
    assert np.abs(corrected - truth).mean() < 0.05 < np.abs(said - truth).mean()


def test_no_trial_is_corrected_by_its_own_half() -> None:
    labels = np.array([True, True, False, False])
    half = np.array([True, True, False, False])
    corrected = cross_fitted(isotonic_regression, labels, np.array([0.5, 0.6, 0.5, 0.6]), half)
    np.testing.assert_array_equal(corrected, [0.0, 0.0, 1.0, 1.0])
    assert np.isnan(cross_fitted(isotonic_regression, labels, np.full(4, 0.5), np.full(4, True))).all()
