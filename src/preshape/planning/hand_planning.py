"""Planners of palm poses, for hands."""

from dataclasses import dataclass

from preshape.errors import InputError
from preshape.grasps.heuristic import HeuristicSettings
from preshape.grasps.space import GraspSpace
from preshape.models.success_model import GraspNetwork
from preshape.planning.bounds import BoxSize
from preshape.planning.grasp_planner import PlannerParts
from preshape.planning.view_planner import ViewPlanner


@dataclass(frozen=True, eq=False)
class HandPlanning:
    """A `GraspPlanning` for a hand.

    Args:
        space: what theta means.
        heuristic: how initial grasps are made.
    """

    space: GraspSpace
    heuristic: HeuristicSettings

    def planner(self, parts: PlannerParts, model: GraspNetwork | None = None) -> ViewPlanner:
        """See `GraspPlanning`."""
        if not isinstance(parts.box, BoxSize):
            raise InputError(
                f"The planner {parts.name} is for rectangles, not for palm poses",
                where=f"grasp space {self.space.name}",
                fix="choose another planner, such as planner=inference, or robot=baxter",
            )
        return ViewPlanner(
            name=parts.name,
            method=parts.method,
            box=parts.box,
            space=self.space,
            heuristic=self.heuristic,
            model=model,
            constraint=parts.constraint,
            prior=parts.prior,
            proposer=parts.proposer,
        )
