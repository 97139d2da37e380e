"""Who plans on a scene when planners compete: planners for a hand, and for rectangles."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float64

from preshape.geometry.pose import pose_over_plane
from preshape.grasps.space import GraspSpace
from preshape.perception.observation import Observation
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.result import PlanResult
from preshape.planning.view_planner import ViewPlanner
from sim.laboratory import SceneView


class Contestant(Protocol):
    """Plans on a scene."""

    def plan(self, view: SceneView) -> GraspPlan:
        """Plan from the view's initial grasps."""


Contestants = Mapping[str, Contestant]
"""By the names of their planners."""


@dataclass(frozen=True, eq=False)
class HandContestant:
    """Plans for a hand.

    Args:
        planner: from views to grasps.
    """

    planner: ViewPlanner

    def plan(self, view: SceneView) -> GraspPlan:
        """See `Contestant`."""
        return self.planner.plan_from(view.observation, view.segmented, view.initial)


class PlannedRectangles(Protocol):
    """What a planner of rectangles returns."""

    @property
    def planner(self) -> str:
        """Its name."""

    @property
    def result(self) -> PlanResult:
        """The rectangles as theta = (u, v, angle, opening)."""


class RectanglePlanning(Protocol):
    """Plans rectangles, as `preshape.planning.rectangle_planner.RectanglePlanner` does."""

    def plan_from(self, observation: Observation, initial: Float64[np.ndarray, "s 4"]) -> PlannedRectangles:
        """Plan from initial rectangles."""


@dataclass(frozen=True, eq=False)
class RectangleContestant:
    """Plans rectangles for a gripper.

    Args:
        planner: from views to rectangles.
        space: what theta means.
    """

    planner: RectanglePlanning
    space: GraspSpace

    def plan(self, view: SceneView) -> GraspPlan:
        """See `Contestant`."""
        initial = np.stack([grasp.theta for grasp in view.initial])
        plan = self.planner.plan_from(view.observation, initial)
        faces = tuple(grasp.face for grasp in view.initial)
        poses = view.observation.camera.T_world_camera, pose_over_plane(view.segmented.plane)
        return GraspPlan(plan.planner, self.space, faces, plan.result, *poses)
