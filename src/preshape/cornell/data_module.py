"""From a folder in the layout of the Cornell data to the batches of a network."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from preshape.cornell.augmentation import Augmentation
from preshape.cornell.data_set import CornellDataSet, CornellImage, read_cornell
from preshape.cornell.folds import split_images
from preshape.cornell.labelled_rectangles import rectangle_table
from preshape.cornell.rectangle_dataset import DrawnBatches, LoadedImage, RectangleDataset
from preshape.cornell.view_store import ViewStore
from preshape.data.folds import HoldOut
from preshape.data.labelled_data import BatchSettings, LabelledData, check_lifted
from preshape.grasps.space import GraspSpace
from preshape.progress import Progress


@runtime_checkable
class FolderMaker(Protocol):
    """Makes a folder in the layout of the Cornell data."""

    def __call__(self, root: Path) -> None:
        """Make what is missing in it.

        Raises:
            InputError: if it cannot be made.
        """


@dataclass(frozen=True)
class AugmentedBatchSettings(BatchSettings):
    """How rectangles are drawn for training.

    Args:
        augmentation: how they are varied.
    """

    augmentation: Augmentation


class CornellDataModule(LabelledData):
    """Labelled rectangles of the data set, with the views of their images, split and in batches.

    No image is ever in two parts.

    Args:
        root: folder of the data set.
        space: grasp space of theta.
        views: makes and keeps the views.
        hold_out: which images are held out, see `split_images`.
        batches: how the rectangles of the others are drawn, and varied.
        threshold: success probability above which a rectangle is recognised as positive.
        maker: makes the folder where it is derived from something else; None for one that is there.
    """

    train: RectangleDataset
    validation: RectangleDataset
    test: RectangleDataset
    batches: AugmentedBatchSettings

    def __init__(
        self,
        *,
        root: str | Path,
        space: GraspSpace,
        views: ViewStore,
        hold_out: HoldOut,
        batches: AugmentedBatchSettings,
        threshold: float = 0.5,
        maker: FolderMaker | None = None,
    ) -> None:
        super().__init__()
        self._root, self._space, self._views, self._hold_out = Path(root), space, views, hold_out
        self.batches, self.threshold = batches, threshold
        self._maker = maker

    def setup(self, stage: str | None = None) -> None:
        """Read the labels and split them; does nothing the second time.

        Raises:
            InputError: if the data set is not complete, damaged or too small.
        """
        if hasattr(self, "data_hash"):
            return
        if self._maker is not None:
            self._maker(self._root)
        self._data = read_cornell(self._root)
        trials = rectangle_table(self._data, self._space)
        self._split = split_images(self._data.objects, self._data.names, self._hold_out)

        def part(numbers: frozenset[int]) -> RectangleDataset:
            rows = trials.where(np.isin(trials.scene_ids, sorted(numbers)))
            return RectangleDataset(rows, {}, self._views.settings.step_px, self.batches.augmentation)

        split = self._split
        self.train, self.validation, self.test = map(part, (split.train, split.validation, split.test))
        self.data_hash = self._data.digest

    @property
    def data(self) -> CornellDataSet:
        """What was read."""
        return self._data

    @property
    def test_images(self) -> tuple[CornellImage, ...]:
        """The images that are held out."""
        return tuple(image for image in self._data.images if image.files.number in self._split.test)

    def keep_lifted(self) -> None:
        """Leave out the negative rectangles, for networks that learn from positive ones alone.

        Raises:
            InputError: if none is left to learn from, or to test with.
        """
        self.train, self.validation, self.test = (
            part.lifted() for part in (self.train, self.validation, self.test)
        )
        check_lifted(self.train, self.test, str(self._root))

    def render(self, *, with_patches: bool) -> None:
        """Load the views of all images, and make those that are not there yet.

        Args:
            with_patches: has no meaning: rectangles are judged by images alone.

        Raises:
            InputError: if a file is truncated or damaged, or views cannot be kept.
        """
        loaded = {}
        with Progress("Loading", len(self._data.images), "images") as progress:
            for image in self._data.images:
                loaded[image.files.number] = LoadedImage(image, self._views.view(image.files))
                progress.advance()
        self.train, self.validation, self.test = (
            part.with_images(loaded) for part in (self.train, self.validation, self.test)
        )

    def training_batches(self) -> DrawnBatches:
        """Rows of the training rectangles, with what their variations follow from."""
        return DrawnBatches(self.positive_batches(), self.batches.seed)
