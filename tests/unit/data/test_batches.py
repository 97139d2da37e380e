"""Training batches: always a positive, the same for the same seed and epoch."""

import numpy as np
import pytest

from preshape.data.batches import InOrder, PositiveBatches
from preshape.errors import InputError

LABELS = np.arange(200) % 25 == 0


def make(min_positives: int = 1, seed: int = 0, batches: int = 300) -> PositiveBatches:
    return PositiveBatches(LABELS, batch_size=8, min_positives=min_positives, batches=batches, seed=seed)


@pytest.mark.parametrize("min_positives", [1, 2])
def test_every_batch_has_enough_positives(min_positives: int) -> None:
    batches = list(make(min_positives))
    assert len(batches) == len(make())
    for batch in batches:
        assert len(set(batch)) == 8
        assert LABELS[batch].sum() >= min_positives


def test_the_natural_prior_can_be_kept() -> None:
    rate = np.mean([LABELS[batch].mean() for batch in make(min_positives=0, batches=2000)])
    assert rate == pytest.approx(LABELS.mean(), abs=0.01)
    assert any(not LABELS[batch].any() for batch in make(min_positives=0))


def test_seed_and_epoch_decide_the_batches() -> None:
    sampler = make()
    first, repeated = list(sampler), list(make())
    assert first == repeated
    sampler.begin_epoch(1)
    assert list(sampler) != first
    sampler.begin_epoch(0)
    assert list(sampler) == first
    assert list(make(seed=1)) != first


@pytest.mark.parametrize(("n", "positives"), [(5, 5), (100, 0)])
def test_impossible_batches_are_refused(n: int, positives: int) -> None:
    labels = np.arange(n) < positives
    with pytest.raises(InputError, match="No batch"):
        PositiveBatches(labels, batch_size=8, min_positives=1, batches=1, seed=0)


def test_in_order_covers_every_row_once() -> None:
    batches = list(InOrder(19, 8))
    assert [row for batch in batches for row in batch] == list(range(19))
    assert len(batches) == len(InOrder(19, 8)) == 3
