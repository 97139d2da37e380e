"""Two networks on the same trials: differences and their intervals."""

import numpy as np
import pytest
from sklearn.metrics import roc_auc_score

from preshape.evaluation.metrics import classification_metrics
from preshape.evaluation.paired_metrics import PairedFold, paired_differences


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def fold(rng: np.random.Generator, *, n: int = 300, noise: float = 0.2) -> PairedFold:
    """A fold in which the second network is the first with noise."""
    first = rng.uniform(size=n)
    second = np.clip(first + noise * rng.normal(size=n), 0, 1)
    return PairedFold(rng.uniform(size=n) < first, first, second, np.arange(n) // 3)


def test_differences_are_those_of_the_figures(rng: np.random.Generator) -> None:
    folds = [fold(rng), fold(rng)]
    found = paired_differences(folds, rng)
    for name in ("auc", "brier", "accuracy"):
        expected = [
            getattr(classification_metrics(own.lifted, own.first, rng=rng), name)
            - getattr(classification_metrics(own.lifted, own.second, rng=rng), name)
            for own in folds
        ]
        assert found[name].value == pytest.approx(np.mean(expected), abs=1e-6)
        assert found[name].low < found[name].value < found[name].high


def test_the_same_network_does_not_differ_from_itself(rng: np.random.Generator) -> None:
    found = paired_differences([fold(rng, noise=0.0)], rng)
    assert all((own.value, own.low, own.high) == (0.0, 0.0, 0.0) for own in found.values())


def test_exchanged_networks_have_exchanged_signs(rng: np.random.Generator) -> None:
    own = fold(rng)
    other = PairedFold(own.lifted, own.second, own.first, own.scenes)
    one, two = (paired_differences([each], np.random.default_rng(1)) for each in (own, other))
    for name, difference in one.items():
        ends = (-two[name].value, -two[name].high, -two[name].low)
        assert (difference.value, difference.low, difference.high) == pytest.approx(ends)


def test_what_is_hard_for_both_does_not_widen_the_interval(rng: np.random.Generator) -> None:
    own = fold(rng, noise=0.02)
    paired = paired_differences([own], rng)["auc"]
    alone = classification_metrics(own.lifted, own.first, rng=rng, groups=own.scenes)
    assert paired.high - paired.low < 0.3 * (alone.auc_high - alone.auc_low)


def test_the_interval_agrees_with_resampling_scenes_one_by_one(rng: np.random.Generator) -> None:
    own, n = fold(rng), 300
    differences = []
    for _ in range(400):
        chosen = np.concatenate(
            [np.flatnonzero(own.scenes == one) for one in rng.integers(0, n // 3, n // 3)]
        )
        areas = [roc_auc_score(own.lifted[chosen], prob[chosen]) for prob in (own.first, own.second)]
        differences.append(areas[0] - areas[1])
    found = paired_differences([own], rng)["auc"]
    assert (found.low, found.high) == pytest.approx(tuple(np.quantile(differences, [0.025, 0.975])), abs=0.01)


def test_one_class_has_no_difference_of_areas(rng: np.random.Generator) -> None:
    one = PairedFold(np.ones(4, dtype=bool), *rng.uniform(size=(2, 4)), np.arange(4))
    found = paired_differences([one], rng)
    assert not found["auc"].known
    assert found["brier"].known
