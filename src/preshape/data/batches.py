"""Which trials make up a batch."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool
from torch.utils.data import Sampler

from preshape.errors import InputError


class PositiveBatches(Sampler[list[int]]):
    """Batches drawn at random until they hold enough positives (paper, section 3.3).

    An epoch is a fixed number of batches and a function of its number and the seed alone, so that a training
    that was interrupted goes on with the batches that it would have seen.

    Args:
        labels: whether each trial lifted.
        batch_size: trials per batch, all different.
        min_positives: a batch with fewer lifted trials is drawn again; 0 keeps the table's share.
        batches: batches per epoch.
        seed: seed of the draws.

    Raises:
        InputError: if the table is too small, or has too few positives.
    """

    def __init__(
        self,
        labels: Bool[np.ndarray, "n"],
        *,
        batch_size: int,
        min_positives: int,
        batches: int,
        seed: int,
    ) -> None:
        positives = int(labels.sum())
        if len(labels) < batch_size or positives < min_positives or batch_size < min_positives:
            raise InputError(
                f"No batch of {batch_size} trials with {min_positives} lifted ones can be drawn "
                f"from {len(labels)} trials with {positives} lifted ones",
                where="dataset.batch_size, dataset.min_positives",
                fix="make them smaller, or collect more trials with `python sim/collect.py`",
            )
        self._labels = labels
        self._batch_size, self._min_positives = batch_size, min_positives
        self._batches, self._seed = batches, seed
        self._epoch = 0

    def begin_epoch(self, epoch: int) -> None:
        """Choose the epoch that the next iteration goes through."""
        # Not called `set_epoch`, or Lightning would call it, and one too high after an interruption.
        self._epoch = epoch

    def __len__(self) -> int:
        return self._batches

    def __iter__(self) -> Iterator[list[int]]:
        rng = np.random.default_rng([self._seed, self._epoch])
        for _ in range(self._batches):
            yield self._draw(rng)

    def _draw(self, rng: np.random.Generator) -> list[int]:
        while True:
            batch = rng.choice(len(self._labels), self._batch_size, replace=False)
            if self._labels[batch].sum() >= self._min_positives:
                rows: list[int] = batch.tolist()
                return rows


class InOrder(Sampler[list[int]]):
    """Every row once, in order, in batches.

    Args:
        rows: number of rows.
        batch_size: rows per batch; the last may have fewer.
    """

    def __init__(self, rows: int, batch_size: int) -> None:
        self._rows, self._batch_size = rows, batch_size

    def __len__(self) -> int:
        return -(-self._rows // self._batch_size)

    def __iter__(self) -> Iterator[list[int]]:
        for first in range(0, self._rows, self._batch_size):
            yield list(range(first, min(first + self._batch_size, self._rows)))
