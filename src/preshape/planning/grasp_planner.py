"""What plans grasps in views, whatever the robot: a planner's parts, and what makes a planner of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from preshape.grasps.heuristic import InitialGrasp
from preshape.models.success_model import GraspNetwork
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentedObject
from preshape.planning.bounds import Box
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.hand_clearance import HandClearance
from preshape.planning.planner import Planner
from preshape.planning.prior_choice import PriorChoice
from preshape.planning.regression import RegressedGrasp


@dataclass(frozen=True, eq=False)
class PlannerParts:
    """What a planner's configuration says (`conf/planner`).

    Args:
        name: name of the planner, for plans and tables.
        method: the planner.
        box: how far it may go from an initial grasp.
        constraint: where the hand may not be; None for anywhere.
        prior: what counts beside the success of a grasp.
        proposer: says one grasp instead of the initial ones, if given.
    """

    name: str
    method: Planner
    box: Box
    constraint: HandClearance | None = None
    prior: PriorChoice = field(default_factory=PriorChoice)
    proposer: RegressedGrasp | None = None


@runtime_checkable
class GraspPlanner(Protocol):
    """Plans grasps for the object in a view."""

    def plan(self, observation: Observation, rng: np.random.Generator) -> GraspPlan:
        """Find the object, make initial grasps, and plan from them.

        Raises:
            InputError: if no object can be made out on a table.
        """

    def plan_from(
        self, observation: Observation, segmented: SegmentedObject, initial: Sequence[InitialGrasp]
    ) -> GraspPlan:
        """Plan from initial grasps that are there already, so that planners can be compared."""


@runtime_checkable
class GraspPlanning(Protocol):
    """What planners of one robot have in common."""

    def planner(self, parts: PlannerParts, model: GraspNetwork | None) -> GraspPlanner:
        """A planner of these parts.

        Args:
            parts: of the planner.
            model: a trained network that predicts success; None if nothing is known about it.

        Raises:
            InputError: if the planner is for other robots.
        """
