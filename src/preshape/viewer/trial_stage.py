"""Where the trials of a table take place, as the viewer needs it; the simulator has one."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import trimesh
from jaxtyping import Float

from preshape.data.scene import Scene
from preshape.data.trial import Trial, TrialOutcome
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentedObject
from preshape.viewer.recording import TrialRecording


@dataclass(frozen=True, eq=False)
class SceneLook:
    """What the camera sees of a scene.

    Args:
        observation: the RGB-D view.
        segmented: the object in it.
    """

    observation: Observation
    segmented: SegmentedObject


@dataclass(frozen=True, eq=False)
class PlacedHand:
    """Where a theta puts the hand.

    Args:
        T_world_palm: pose of the palm frame.
        joints: positions of the hand's joints (rad or m) by name.
    """

    T_world_palm: Float[np.ndarray, "4 4"]
    joints: dict[str, float]


@dataclass(frozen=True)
class NotExecuted:
    """Why the arm did not try a grasp.

    Args:
        outcome: UNREACHABLE or BLOCKED.
        reason: one sentence.
    """

    outcome: TrialOutcome
    reason: str


@runtime_checkable
class TrialStage(Protocol):
    """Shows scenes and repeats trials."""

    def look(self, scene: Scene) -> SceneLook:
        """The view of a scene.

        Raises:
            InputError: if no object can be made out in it.
        """

    def place(self, scene: Scene, theta: Float[np.ndarray, "d"]) -> PlacedHand:
        """Where a theta puts the hand.

        Raises:
            InputError: if the view does not say where the grasp is.
        """

    def object_mesh(self, object_id: str) -> tuple[trimesh.Trimesh, ...]:
        """What an object looks like, in its own frame, one mesh for each material.

        Raises:
            InputError: if there is no such object.
        """

    def perform(self, scene: Scene, trial: Trial) -> TrialRecording | NotExecuted:
        """Try the trial's planned grasp with its own seed, or read what came of it before."""
