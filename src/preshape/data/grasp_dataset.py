"""Labelled grasps as examples for a network."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float16
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
        label: 1 if it lifted the object, else 0.
    """

    view: ViewBatch
    theta: Float[Tensor, "b d"]
    label: Float[Tensor, "b"]


class GraspDataset(Dataset[GraspBatch]):
    """Executed trials with the views of their scenes.

    Patches stay on disk until they are used. All else fits into memory.

    Args:
        trials: executed trials; `reached` is what the network learns from.
        scenes: their scenes, by number.
        cache: views of scenes.
        with_patches: whether the views come with patches, which are most of the time that they take.
    """

    def __init__(
        self, trials: TrialTable, scenes: Mapping[int, Scene], cache: ViewCache, with_patches: bool = True
    ) -> None:
        self.trials = trials
        self._scenes, self._cache, self._with_patches = scenes, cache, with_patches
        self.theta: Float[Tensor, "n d"] = torch.as_tensor(trials.reached, dtype=torch.float32)
        self.labels: Float[Tensor, "n"] = torch.as_tensor(trials.lifted.astype(np.float32))
        self._scene_ids, self._scene_of = np.unique(trials.scene_ids, return_inverse=True)

    def __len__(self) -> int:
        return len(self.trials)

    @property
    def scenes(self) -> list[Scene]:
        """The scene of every example, each once."""
        return [self._scenes[scene_id] for scene_id in self._scene_ids.tolist()]

    def lifted(self) -> "GraspDataset":
        """The examples that lifted."""
        return GraspDataset(
            self.trials.where(self.trials.lifted), self._scenes, self._cache, self._with_patches
        )

    def without_patches(self) -> "GraspDataset":
        """The same examples for a network that does not look at patches."""
        return GraspDataset(self.trials, self._scenes, self._cache, with_patches=False)

    def __getitem__(self, rows: Sequence[int]) -> GraspBatch:
        """The examples of these rows as one batch; patches in half precision, as they are stored."""
        of_scenes = self._scene_of[rows]
        view = ViewBatch(*(part[torch.from_numpy(of_scenes)] for part in self._views_without_patches))
        if self._with_patches:
            ids = self._scene_ids[of_scenes].tolist()
            view = view._replace(patch=self._patches(ids))
        return GraspBatch(view, self.theta[rows], self.labels[rows])

    def patches(self) -> Iterator[Float16[Tensor, "8 h w"]]:
        """The patch of every scene, once."""
        for scene in self.scenes:
            yield torch.from_numpy(self._cache.patch(scene))

    def _patches(self, scene_ids: Sequence[int]) -> Float16[Tensor, "b 8 h w"]:
        """The patches of scenes, with the channels last in memory, as convolutions on a CPU want them."""
        patches = np.empty((len(scene_ids), PATCH_SIZE, PATCH_SIZE, len(CHANNEL_NAMES)), dtype=np.float16)

        def read(place: int) -> None:
            patch = self._cache.patch(self._scenes[scene_ids[place]])
            patches[place] = patch.transpose(1, 2, 0)

        with ThreadPoolExecutor(torch.get_num_threads()) as threads:
            list(threads.map(read, range(len(scene_ids))))
        return torch.from_numpy(patches).permute(0, 3, 1, 2)

    @cached_property
    def _views_without_patches(self) -> ViewBatch:
        """What is known of every scene besides its patch."""
        clouds = [self._cache.cloud(scene) for scene in self.scenes]
        return ViewBatch.of(clouds, [scene.camera for scene in self.scenes])
