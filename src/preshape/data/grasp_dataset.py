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


class GraspBatch(NamedTuple):
    """A batch of labelled grasps.

    Args:
        patch: object patch of each grasp's view.
        theta: the grasp that was really reached (camera frame, m and rad).
        label: 1 if it lifted the object, else 0.
    """

    patch: Float[Tensor, "b 8 h w"]
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

    def __getitem__(self, rows: Sequence[int]) -> GraspBatch:
        """The examples of these rows as one batch; patches in half precision, as they are stored."""
        patches = [self._cache[self._scenes[scene_id]] for scene_id in self.trials.scene_ids[rows].tolist()]
        return GraspBatch(torch.from_numpy(np.stack(patches)), self.theta[rows], self.labels[rows])

    def patches(self) -> Iterator[Float16[Tensor, "8 h w"]]:
        """The patch of every scene, once."""
        for scene_id in np.unique(self.trials.scene_ids).tolist():
            yield torch.from_numpy(self._cache[self._scenes[scene_id]])
