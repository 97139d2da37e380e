"""Planners of rectangles, for two-finger grippers."""

from dataclasses import dataclass, replace

from preshape.cornell.object_finder import FinderSettings
from preshape.cornell.rectangle_views import RectangleViewSettings
from preshape.errors import InputError
from preshape.grasps.rectangle_pose import RectanglePoseSettings
from preshape.grasps.space import GraspSpace
from preshape.models.success_model import GraspNetwork, SuccessModel
from preshape.planning.bounds import RectangleBox
from preshape.planning.grasp_planner import PlannerParts
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.max_eval import MaxEvalPlanner
from preshape.planning.rectangle_planner import RectanglePlanner, RectangleStarts

UNMOVED = RectangleBox(0.0, 0.0)
"""The box of planners that leave rectangles as they are."""


@dataclass(frozen=True, eq=False)
class RectanglePlanning:
    """A `GraspPlanning` for rectangles.

    Args:
        space: what theta means.
        starts: initial rectangles.
        views: how the network sees images.
        finder: how the object is found.
        pose: how the gripper is put at a rectangle.
    """

    space: GraspSpace
    starts: RectangleStarts
    views: RectangleViewSettings
    finder: FinderSettings
    pose: RectanglePoseSettings

    def planner(self, parts: PlannerParts, model: GraspNetwork | None = None) -> RectanglePlanner:
        """See `GraspPlanning`."""
        box = UNMOVED if isinstance(parts.method, HeuristicPlanner | MaxEvalPlanner) else parts.box
        if not isinstance(box, RectangleBox):
            raise InputError(
                f"The planner {parts.name} is for palm poses, not for rectangles",
                where=f"grasp space {self.space.name}",
                fix="choose planner=paper_rectangle, rectangle_inference, max_eval or heuristic",
            )
        if model is not None and not isinstance(model, SuccessModel):
            raise InputError(
                f"The network `{model.name}` does not predict the success of grasps",
                where=f"grasp space {self.space.name}",
                fix="choose model=patches_cnn",
            )
        planner = RectanglePlanner(
            parts.name, parts.method, box, self.space, self.starts, self.views, self.finder, pose=self.pose
        )
        return planner if model is None else replace(planner, model=model)
