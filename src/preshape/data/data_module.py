"""From a folder of labelled grasps to the batches of a network."""

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path

import numpy as np
from jaxtyping import Int

from preshape.data.folds import HoldOut, split_trials
from preshape.data.grasp_dataset import GraspDataset
from preshape.data.joined_tables import joined
from preshape.data.labelled_data import BatchSettings, LabelledData, check_lifted
from preshape.data.tables import data_hash, read_data_set
from preshape.data.trial_table import SceneTable, TableOrigin, TrialTable
from preshape.data.view_cache import ViewCache
from preshape.errors import InputError
from preshape.grasps.space import GraspSpace


class GraspDataModule(LabelledData):
    """Executed trials of a data set, rendered, split and in batches.

    Args:
        folder: the data set: `scenes.parquet` and `trials.parquet`.
        origin: robot, object set and camera that they must have been collected with.
        space: grasp space of theta.
        views: makes and keeps the views of the scenes.
        hold_out: which trials are held out.
        batches: how the others are drawn.
        added: folders of further data sets, which are put behind the first.
        trials: how many executed trials are used, from the first of the table on; None for all.
        trials_learned: learn as if so many were used: of the trials for training and for validation random
            ones are left out, the test trials stay; None for none. A smaller number keeps some of a larger's.
        soft_labels: learn, where trials were repeated, from the share of repetitions that lifted. Tests and
            validation ask whether the trial itself lifted.
    """

    train: GraspDataset
    validation: GraspDataset
    test: GraspDataset

    def __init__(
        self,
        *,
        folder: str | Path,
        origin: TableOrigin,
        space: GraspSpace,
        views: ViewCache,
        hold_out: HoldOut,
        batches: BatchSettings,
        added: Sequence[str | Path] = (),
        trials: int | None = None,
        trials_learned: int | None = None,
        soft_labels: bool = False,
    ) -> None:
        super().__init__()
        self._folders = tuple(Path(one) for one in (folder, *added))
        self._origin, self._space = origin, space
        self._views = views
        self._hold_out, self.batches, self._wanted = hold_out, batches, trials
        self._learned, self._soft_labels = trials_learned, soft_labels

    def setup(self, stage: str | None = None) -> None:
        """Read the tables and split them; does nothing the second time.

        Raises:
            InputError: if a table cannot be used, was collected with something else, or is too small.
        """
        if hasattr(self, "data_hash"):
            return
        scenes, trials = reduce(joined, map(self._read, self._folders))
        executed = self._first(trials.executed)
        split = split_trials(executed, self._hold_out)

        def part(rows: Int[np.ndarray, "rows"]) -> GraspDataset:
            mask = np.isin(np.arange(len(executed)), rows)
            return GraspDataset(executed.where(mask), scenes.by_id, self._views)

        learned = (self._thinned(rows, len(executed)) for rows in (split.train, split.validation))
        self.train, self.validation, self.test = (part(rows) for rows in (*learned, split.test))
        if self._soft_labels:
            self._check_soft_labels()
            self.train = replace(self.train, soft_labels=True)
        self.data_hash = data_hash(*self._folders)

    def _read(self, folder: Path) -> tuple[SceneTable, TrialTable]:
        return read_data_set(folder, self._space, self._origin)

    def _thinned(self, rows: Int[np.ndarray, "rows"], executed: int) -> Int[np.ndarray, "kept"]:
        """The rows that are kept if fewer trials than were executed are to be learned from."""
        if self._learned is None:
            return rows
        self._check_number(self._learned, executed, "trials_learned")
        order = np.random.default_rng(self._hold_out.seed).permutation(rows)
        return np.sort(order[: round(len(rows) * self._learned / executed)])

    def _first(self, executed: TrialTable) -> TrialTable:
        """The trials that are used of all executed ones."""
        if self._wanted is None:
            return executed
        self._check_number(self._wanted, len(executed), "trials")
        return executed.where(np.arange(len(executed)) < self._wanted)

    def _check_number(self, wanted: int, executed: int, setting: str) -> None:
        if not 0 < wanted <= executed:
            raise InputError(
                f"{wanted} trials are wanted, but the table has {executed} executed ones",
                where=", ".join(map(str, self._folders)),
                fix=f"set dataset.data.{setting} to at most as many, or to null for all",
            )

    def _check_soft_labels(self) -> None:
        if np.isnan(self.train.trials.soft_labels).all():
            raise InputError(
                "No trial to learn from was repeated, so none has a soft label",
                where=", ".join(map(str, self._folders)),
                fix="collect trials with collect.repeats=5, or set dataset.data.soft_labels=false",
            )

    def keep_lifted(self) -> None:
        """Leave out the trials that failed, for networks that learn from successes alone.

        Raises:
            InputError: if none is left to learn from, or to test with.
        """
        self.train, self.validation, self.test = (
            part.lifted() for part in (self.train, self.validation, self.test)
        )
        check_lifted(self.train, self.test, ", ".join(map(str, self._folders)))

    def render(self, *, with_patches: bool) -> None:
        """Render what is not rendered yet.

        Args:
            with_patches: whether views come with patches; networks that do not look at them are spared most
                of the time and space that views take.

        Raises:
            InputError: if views cannot be made or kept.
        """
        parts = self.train, self.validation, self.test
        scenes = {scene.scene_id: scene for part in parts for scene in part.scenes}
        self._views.fill(list(scenes.values()), with_patches=with_patches)
        if not with_patches:
            self.train, self.validation, self.test = (replace(part, with_patches=False) for part in parts)
