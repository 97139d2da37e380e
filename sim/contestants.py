"""Who plans on a scene when planners compete: planners for a hand, and for rectangles."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from jaxtyping import Float64

from preshape.data.trial import Face
from preshape.files import write_json
from preshape.perception.observation import Observation
from preshape.planning.plan_files import write_plan
from preshape.planning.result import PlanResult
from preshape.planning.view_planner import ViewPlanner
from sim.laboratory import SceneView


@dataclass(frozen=True, eq=False)
class ContestPlan:
    """What a planner found on a scene.

    Args:
        planner: its name.
        faces: face that each start aimed at; decides how the hand closes.
        result: the grasps.
        save: writes it as JSON.
    """

    planner: str
    faces: tuple[Face, ...]
    result: PlanResult
    save: Callable[[Path], None]


class Contestant(Protocol):
    """Plans on a scene."""

    def plan(self, view: SceneView) -> ContestPlan:
        """Plan from the view's initial grasps."""


@dataclass(frozen=True, eq=False)
class HandContestant:
    """Plans for a hand.

    Args:
        planner: from views to grasps.
    """

    planner: ViewPlanner

    def plan(self, view: SceneView) -> ContestPlan:
        """See `Contestant`."""
        plan = self.planner.plan_from(view.observation, view.segmented, view.initial)
        return ContestPlan(plan.planner, plan.faces, plan.result, partial(write_plan, plan=plan))


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
    """

    planner: RectanglePlanning

    def plan(self, view: SceneView) -> ContestPlan:
        """See `Contestant`."""
        initial = np.stack([grasp.theta for grasp in view.initial])
        plan = self.planner.plan_from(view.observation, initial)
        faces = tuple(grasp.face for grasp in view.initial)
        content = {"planner": plan.planner, **vars(plan.result)}
        save = partial(write_json, content=content)
        return ContestPlan(plan.planner, faces, plan.result, save)


Contestants = Mapping[str, Contestant]
"""By the names of their planners."""
