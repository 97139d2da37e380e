"""Labelled rectangles as examples for a network."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float16
from torch import Tensor
from torch.utils.data import Dataset, Sampler

from preshape.cornell.augmentation import Augmentation
from preshape.cornell.data_set import CornellImage
from preshape.cornell.rectangle_views import RectangleView, rectangle_batch
from preshape.data.batches import PositiveBatches
from preshape.data.grasp_dataset import GraspBatch
from preshape.data.trial_table import TrialTable

AROUND_PX = 100
"""Half the width of the paper's patch at the palm."""


class DrawnRows(NamedTuple):
    """Rows of a training batch, and what seeds the variations of its examples."""

    rows: list[int]
    seed: tuple[int, ...]


class DrawnBatches(Sampler[DrawnRows]):
    """Training batches that say how their examples are varied: a function of seed and epoch alone.

    Args:
        batches: the batches.
        seed: of the variations.
    """

    def __init__(self, batches: PositiveBatches, seed: int) -> None:
        self._batches, self._seed, self._epoch = batches, seed, 0

    def begin_epoch(self, epoch: int) -> None:
        """Choose the epoch that the next iteration goes through."""
        self._epoch = epoch
        self._batches.begin_epoch(epoch)

    def __len__(self) -> int:
        return len(self._batches)

    def __iter__(self) -> Iterator[DrawnRows]:
        for number, rows in enumerate(self._batches):
            yield DrawnRows(rows, (self._seed, self._epoch, number))


@dataclass(frozen=True, eq=False)
class LoadedImage:
    """An image of the data set with its view, in memory.

    Args:
        image: files and labels.
        view: how networks see it.
    """

    image: CornellImage
    view: RectangleView


class RectangleDataset(Dataset[GraspBatch]):
    """Labelled rectangles with the views of their images, which stay in memory.

    Args:
        trials: the rectangles; a scene is an image.
        images: the images by number; empty until they are loaded.
        step_px: pixels of an image along each pixel of its view.
        augmentation: how training batches are varied.
    """

    def __init__(
        self,
        trials: TrialTable,
        images: Mapping[int, LoadedImage],
        step_px: int,
        augmentation: Augmentation,
    ) -> None:
        self.trials = trials
        self.theta: Float[Tensor, "n d"] = torch.as_tensor(trials.reached, dtype=torch.float32)
        self.labels: Float[Tensor, "n"] = torch.as_tensor(trials.lifted.astype(np.float32))
        self.images, self._step_px, self._augmentation = images, step_px, augmentation

    def __len__(self) -> int:
        return len(self.trials)

    def lifted(self) -> "RectangleDataset":
        """The positive rectangles."""
        trials = self.trials.where(self.trials.lifted)
        return RectangleDataset(trials, self.images, self._step_px, self._augmentation)

    def with_images(self, images: Mapping[int, LoadedImage]) -> "RectangleDataset":
        """The same rectangles with these images."""
        return RectangleDataset(self.trials, images, self._step_px, self._augmentation)

    def patches(self) -> Iterator[Float16[Tensor, "8 h w"]]:
        """The part of every image that networks see around its rectangles, once."""
        for number in np.unique(self.trials.scene_ids).tolist():
            centres = self.trials.reached[self.trials.scene_ids == number, :2]
            low = np.maximum(centres.min(axis=0) - AROUND_PX, 0) // self._step_px
            high = (centres.max(axis=0) + AROUND_PX) // self._step_px + 1
            (left, top), (right, bottom) = low.astype(int), high.astype(int)
            yield torch.from_numpy(self.images[number].view.image[:, top:bottom, left:right])

    def __getitem__(self, rows: Sequence[int] | DrawnRows) -> GraspBatch:
        """The examples of these rows as one batch; varied, and with background, if they were drawn."""
        if not isinstance(rows, DrawnRows):
            return self._batch(self._loaded(rows), self.theta[rows], self.labels[rows])
        rng = np.random.default_rng(rows.seed)
        loaded = self._loaded(rows.rows)
        theta = self._augmentation.moved(self.theta[rows.rows], rng)
        background, behind = self._background(loaded, rng)
        labels = torch.cat((self.labels[rows.rows], torch.zeros(len(background))))
        return self._batch(loaded + behind, torch.cat((theta, background)), labels, rng)

    def _loaded(self, rows: Sequence[int]) -> list[LoadedImage]:
        return [self.images[number] for number in self.trials.scene_ids[rows].tolist()]

    def _background(
        self, loaded: Sequence[LoadedImage], rng: np.random.Generator
    ) -> tuple[Float[Tensor, "k 4"], list[LoadedImage]]:
        """Rectangles of the background of some of the images, and these."""
        count = round(self._augmentation.background * len(loaded))
        drawn: list[Float[np.ndarray, "4"]] = []
        behind = []
        for place in rng.choice(len(loaded), count, replace=False).tolist():
            theta = self._augmentation.drawn_background(loaded[place].image.positives, rng)
            if theta is not None:
                drawn.append(theta)
                behind.append(loaded[place])
        return torch.tensor(np.array(drawn).reshape(-1, 4), dtype=torch.float32), behind

    def _batch(
        self,
        loaded: Sequence[LoadedImage],
        theta: Float[Tensor, "b 4"],
        labels: Float[Tensor, "b"],
        rng: np.random.Generator | None = None,
    ) -> GraspBatch:
        view = rectangle_batch([own.view for own in loaded])
        if rng is not None:
            theta = self._augmentation.seen_otherwise(view, theta, rng)
        return GraspBatch(view, theta, labels)
