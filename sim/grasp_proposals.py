"""Which grasps are tried on a scene before anything is learned."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from preshape.data.trial import Face
from preshape.geometry.camera import Camera
from preshape.grasps.exploration import ExplorationSettings, explored_grasps
from preshape.grasps.heuristic import HeuristicSettings, InitialGrasp, heuristic_grasps
from preshape.grasps.space import GraspSpace
from preshape.perception.segmentation import SegmentedObject


class GraspProposals(Protocol):
    """Makes grasps from what is seen of an object; the same generator state gives the same ones."""

    @property
    def starts(self) -> int:
        """Most initial grasps of one view."""

    @property
    def most(self) -> int:
        """Most grasps of one view, the strayed ones included."""

    def initial(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """Where planning starts."""

    def strayed(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """Grasps around these, for a network to learn from."""


@dataclass(frozen=True, eq=False)
class HeuristicProposals:
    """The paper's heuristic grasps of a hand, and the same moved and tilted.

    Args:
        space: what theta means.
        heuristic: how initial grasps are made.
        explored: strayed grasps per face.
        position_m, rotation_rad: how far they stray; see `ExplorationSettings`.
    """

    space: GraspSpace
    heuristic: HeuristicSettings
    explored: int
    position_m: float
    rotation_rad: float

    @property
    def starts(self) -> int:
        """See `GraspProposals`."""
        return len(Face)

    @property
    def most(self) -> int:
        """See `GraspProposals`."""
        return self.starts * (1 + self.explored)

    def initial(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """One for each face in view (paper, section 4.1)."""
        return heuristic_grasps(segmented, self.space, self.heuristic, camera, rng)

    def strayed(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """New draws, each with its palm moved and tilted at random."""
        settings = ExplorationSettings(self.explored, self.position_m, self.rotation_rad)
        return explored_grasps(segmented, self.space, self.heuristic, settings, camera, rng)
