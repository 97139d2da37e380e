"""Labelled grasps in parts to learn from and to be tested with, and in batches."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import lightning
from jaxtyping import Float
from torch import Tensor
from torch.utils.data import DataLoader, Sampler

from preshape.data.batches import InOrder, PositiveBatches
from preshape.data.grasp_dataset import GraspBatch
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError
from preshape.evaluation.decisions import PAPER_THRESHOLD


@dataclass(frozen=True)
class BatchSettings:
    """How trials are drawn for training.

    Args:
        batch_size: trials per batch.
        min_positives: lifted trials that a training batch has at least; 0 keeps the table's share.
        batches_per_epoch: training batches between two validations.
        seed: seed of the draws.
    """

    batch_size: int
    min_positives: int
    batches_per_epoch: int
    seed: int


@runtime_checkable
class Examples(Protocol):
    """Executed trials as examples for a network."""

    @property
    def trials(self) -> TrialTable:
        """The trials."""

    @property
    def theta(self) -> Float[Tensor, "n d"]:
        """Their grasps."""

    @property
    def labels(self) -> Float[Tensor, "n"]:
        """How probably each of them lifts, as far as is known: 0, 1, or the share of repetitions."""

    def __len__(self) -> int: ...

    def __getitem__(self, rows: Sequence[int]) -> GraspBatch:
        """The examples of these rows as one batch."""

    def patches(self) -> Iterator[Tensor]:
        """Images (8, h, w) from which the statistics of the channels are taken."""


class LabelledData(lightning.LightningDataModule, ABC):
    """Labelled grasps, split and in batches.

    Attributes:
        train, validation, test: the parts; known after `setup`, with images after `render`.
        data_hash: digest of what was read; known after `setup`.
        batches: how training examples are drawn.
        threshold: success probability above which success is predicted.
    """

    train: Examples
    validation: Examples
    test: Examples
    data_hash: str
    batches: BatchSettings
    threshold: float = PAPER_THRESHOLD

    @abstractmethod
    def setup(self, stage: str | None = None) -> None:
        """Read the labels and split them; does nothing the second time.

        Raises:
            InputError: if the data cannot be used.
        """

    @abstractmethod
    def render(self, *, with_patches: bool) -> None:
        """Make the views that are not there yet.

        Args:
            with_patches: whether views come with images.

        Raises:
            InputError: if views cannot be made or kept.
        """

    @abstractmethod
    def keep_lifted(self) -> None:
        """Leave out the trials that failed, for networks that learn from successes alone.

        Raises:
            InputError: if none is left to learn from, or to test with.
        """

    def train_dataloader(self) -> DataLoader[GraspBatch]:
        """Random batches with enough positives."""
        return _loader(self.train, self.training_batches())

    def training_batches(self) -> Sampler[Any]:
        """The batches of the training examples, as these look them up."""
        return self.positive_batches()

    def positive_batches(self) -> PositiveBatches:
        """Rows of training batches with enough positives."""
        settings = self.batches
        return PositiveBatches(
            self.train.trials.lifted,
            batch_size=settings.batch_size,
            min_positives=settings.min_positives,
            batches=settings.batches_per_epoch,
            seed=settings.seed,
        )

    def val_dataloader(self) -> DataLoader[GraspBatch]:
        """The validation trials in order."""
        return _loader(self.validation, InOrder(len(self.validation), self.batches.batch_size))

    def test_dataloader(self) -> DataLoader[GraspBatch]:
        """The test trials in order."""
        return _loader(self.test, InOrder(len(self.test), self.batches.batch_size))

    def predict_dataloader(self) -> DataLoader[GraspBatch]:
        """The test trials in order."""
        return self.test_dataloader()


def check_lifted(train: Examples, test: Examples, where: str) -> None:
    """Refuse parts without a grasp that lifted.

    Raises:
        InputError: if none is left to learn from, or to test with.
    """
    if not len(train) or not len(test):
        raise InputError(
            "No grasp lifted its object among those to learn from, or among those to test with",
            where=where,
            fix="collect more trials with `python sim/collect.py`",
        )


def _loader(examples: Examples, batches: Sampler[Any]) -> DataLoader[GraspBatch]:
    # The sampler already yields whole batches, and the examples look them up at once.
    return DataLoader(examples, sampler=batches, batch_size=None)  # type: ignore[arg-type]
