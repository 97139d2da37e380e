"""Labelled grasps as examples for a network."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float16
from torch import Tensor
from torch.utils.data import Dataset

from preshape.data.images import PatchCache
from preshape.data.scene import Scene
from preshape.data.trial_table import TrialTable
from preshape.perception.patch import ObjectPatch, object_centre
from preshape.perception.view_batch import ViewBatch, patch_intrinsics


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
    """Executed trials with the patches of their scenes, which stay on disk until they are used.

    Args:
        trials: executed trials; `reached` is what the network learns from.
        scenes: their scenes, by number.
        cache: patches of scenes.
    """

    def __init__(self, trials: TrialTable, scenes: Mapping[int, Scene], cache: PatchCache) -> None:
        self.trials = trials
        self._scenes = scenes
        self._cache = cache
        self.theta: Float[Tensor, "n d"] = torch.as_tensor(trials.reached, dtype=torch.float32)
        self.labels: Float[Tensor, "n"] = torch.as_tensor(trials.lifted.astype(np.float32))

    def __len__(self) -> int:
        return len(self.trials)

    def lifted(self) -> "GraspDataset":
        """The examples that lifted."""
        return GraspDataset(self.trials.where(self.trials.lifted), self._scenes, self._cache)

    def __getitem__(self, rows: Sequence[int]) -> GraspBatch:
        """The examples of these rows as one batch; patches in half precision, as they are stored."""
        scenes = [self._scenes[scene_id] for scene_id in self.trials.scene_ids[rows].tolist()]
        patches = [self._cache[scene] for scene in scenes]
        channels = np.stack([patch.channels for patch in patches])
        intrinsics = [_intrinsics(scene, patch) for scene, patch in zip(scenes, patches, strict=True)]
        view = ViewBatch(torch.from_numpy(channels), torch.tensor(np.stack(intrinsics), dtype=torch.float32))
        return GraspBatch(view, self.theta[rows], self.labels[rows])

    def patches(self) -> Iterator[Float16[Tensor, "8 h w"]]:
        """The patch of every scene, once."""
        for scene_id in np.unique(self.trials.scene_ids).tolist():
            yield torch.from_numpy(self._cache[self._scenes[scene_id]].channels)


def _intrinsics(scene: Scene, patch: ObjectPatch) -> Float[np.ndarray, "4"]:
    return patch_intrinsics(scene.camera, object_centre(patch.T_camera_box, scene.camera))
