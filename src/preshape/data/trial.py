"""A trial: one grasp, tried on one scene, labelled by what happened."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float


class TrialOutcome(StrEnum):
    """How a trial ended. Only LIFTED is a success."""

    LIFTED = "lifted"
    """At least 0.13 m above its resting height at the end, held by the hand, not thrown."""
    DROPPED = "dropped"
    """Rose with the hand and was lost, or slid too far through it."""
    MISSED = "missed"
    """The hand closed and lifted without the object."""
    UNREACHABLE = "unreachable"
    """No arm configuration reaches the planned palm pose. Never a failed grasp."""
    BLOCKED = "blocked"
    """Arm configurations exist, but all collide or no free path leads there. Never a failed grasp."""
    UNSTABLE = "unstable"
    """The simulation diverged, or the object did not come to rest. Never a failed grasp."""

    @property
    def executed(self) -> bool:
        """Whether the hand really tried the grasp, so that the trial is a labelled example."""
        return self in (TrialOutcome.LIFTED, TrialOutcome.DROPPED, TrialOutcome.MISSED)


class GraspType(StrEnum):
    """Which closing rule the controller uses (paper, section 4.1)."""

    OVERHEAD = "overhead"
    SIDE = "side"


class Face(StrEnum):
    """The face of the object's bounding box that an initial grasp aims at."""

    TOP = "top"
    SIDE_NEAREST = "side_nearest"
    SIDE_SECOND = "side_second"

    @property
    def grasp_type(self) -> GraspType:
        """Top faces are grasped from overhead, the others from the side."""
        return GraspType.OVERHEAD if self is Face.TOP else GraspType.SIDE


@dataclass(frozen=True, eq=False)
class Trial:
    """One row of a trial table.

    Args:
        trial_id, scene_id: numbers of the trial and of its scene.
        object_id: name of the object.
        planner: who planned the grasp (`heuristic`, `inference`, ...).
        face: face of the bounding box that the initial grasp aimed at.
        initial, planned, reached: theta before planning, as planned, and as the robot really reached it
            (palm from the simulated joints; NaN if it was never reached). Camera frame, m and rad.
        outcome: how it ended.
        lift_height_m: height of the object over its resting height at the end; NaN if not executed.
        success_prob: what the planner predicted for `planned`; NaN if it predicted nothing.
        seed: seed of everything random in the trial.
        scene_s, planning_s, physics_s, rendering_s: wall-clock seconds of each part.
        soft_label: share of LIFTED among repetitions under small disturbances; NaN if it was not repeated.
    """

    trial_id: int
    scene_id: int
    object_id: str
    planner: str
    face: Face
    initial: Float[np.ndarray, "d"]
    planned: Float[np.ndarray, "d"]
    reached: Float[np.ndarray, "d"]
    outcome: TrialOutcome
    lift_height_m: float
    success_prob: float
    seed: int
    scene_s: float
    planning_s: float
    physics_s: float
    rendering_s: float
    soft_label: float = float("nan")
