"""Labelled grasps as examples for a network."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float16, Int
from torch import Tensor
from torch.utils.data import Dataset

from preshape.data.scene import Scene
from preshape.data.trial_table import TrialTable
from preshape.data.view_cache import ViewCache
from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.object_view import PATCH_SIZE
from preshape.perception.view_batch import ViewBatch


class GraspBatch(NamedTuple):
    """A batch of labelled grasps.

    Args:
        view: each grasp's view.
        theta: the grasp that was really reached (camera frame, m and rad).
        label: 1 if it lifted the object, else 0; or the share of its repetitions that did.
    """

    view: ViewBatch
    theta: Float[Tensor, "b d"]
    label: Float[Tensor, "b"]


@dataclass(frozen=True, eq=False)
class GraspDataset(Dataset[GraspBatch]):
    """Executed trials with the views of their scenes.

    Patches stay on disk until they are used. All else fits into memory.

    Args:
        trials: executed trials; `reached` is what the network learns from.
        scenes_by_id: their scenes, by number.
        cache: views of scenes.
        with_patches: whether the views come with patches, which are most of the time that they take.
        soft_labels: whether the label of a trial that was repeated is the share of repetitions that lifted.
    """

    trials: TrialTable
    scenes_by_id: Mapping[int, Scene]
    cache: ViewCache
    with_patches: bool = True
    soft_labels: bool = False

    def __len__(self) -> int:
        return len(self.trials)

    @property
    def scenes(self) -> list[Scene]:
        """The scene of every example, each once."""
        return [self.scenes_by_id[scene_id] for scene_id in self._scene_ids_and_rows[0].tolist()]

    def lifted(self) -> "GraspDataset":
        """The examples that lifted."""
        return replace(self, trials=self.trials.where(self.trials.lifted))

    @cached_property
    def theta(self) -> Float[Tensor, "n d"]:
        """The grasp that was really reached in each trial."""
        return torch.as_tensor(self.trials.reached, dtype=torch.float32)

    @cached_property
    def labels(self) -> Float[Tensor, "n"]:
        """1 for each trial that lifted the object, else 0; or its soft label, if asked for and known."""
        labels = self.trials.lifted.astype(np.float32)
        if self.soft_labels:
            soft = self.trials.soft_labels.astype(np.float32)
            labels = np.where(np.isnan(soft), labels, soft)
        return torch.as_tensor(labels)

    def __getitem__(self, rows: Sequence[int]) -> GraspBatch:
        """The examples of these rows as one batch; patches in half precision, as they are stored."""
        scene_ids, scene_of = self._scene_ids_and_rows
        of_scenes = scene_of[rows]
        view = ViewBatch(*(part[torch.from_numpy(of_scenes)] for part in self._views_without_patches))
        if self.with_patches:
            ids = scene_ids[of_scenes].tolist()
            view = view._replace(patch=self._patches(ids))
        return GraspBatch(view, self.theta[rows], self.labels[rows])

    def patches(self) -> Iterator[Float16[Tensor, "8 h w"]]:
        """The patch of every scene, once."""
        for scene in self.scenes:
            yield torch.from_numpy(self.cache.patch(scene))

    def _patches(self, scene_ids: Sequence[int]) -> Float16[Tensor, "b 8 h w"]:
        """The patches of scenes, with the channels last in memory, as convolutions on a CPU want them."""
        patches = np.empty((len(scene_ids), PATCH_SIZE, PATCH_SIZE, len(CHANNEL_NAMES)), dtype=np.float16)

        def read(place: int) -> None:
            patch = self.cache.patch(self.scenes_by_id[scene_ids[place]])
            patches[place] = patch.transpose(1, 2, 0)

        with ThreadPoolExecutor(torch.get_num_threads()) as threads:
            list(threads.map(read, range(len(scene_ids))))
        return torch.from_numpy(patches).permute(0, 3, 1, 2)

    @cached_property
    def _scene_ids_and_rows(self) -> tuple[Int[np.ndarray, "scenes"], Int[np.ndarray, "n"]]:
        """The numbers of the scenes, each once, and which of them is that of each trial."""
        return np.unique(self.trials.scene_ids, return_inverse=True)

    @cached_property
    def _views_without_patches(self) -> ViewBatch:
        """What is known of every scene besides its patch."""
        clouds = [self.cache.cloud(scene) for scene in self.scenes]
        return ViewBatch.of(clouds, [scene.camera for scene in self.scenes])
