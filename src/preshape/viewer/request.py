"""What can be asked of the viewer."""

from dataclasses import dataclass

from preshape.errors import InputError


@dataclass(frozen=True)
class Request:
    """What a user asks for.

    Args:
        robot: name of the robot.
        has_body: whether there is a robot to show.
        has_palm_poses: whether its grasps are palm poses, which the viewer's planners plan.
        wants_plan: whether a view or weights are given, for which one has to plan.
    """

    robot: str
    has_body: bool
    has_palm_poses: bool
    wants_plan: bool

    def check(self) -> None:
        """Refuse what the viewer cannot show.

        Raises:
            InputError: saying what it can.
        """
        gripper = "browse a gripper's trials with `python src/view.py experiment=gripper_trials`"
        if not self.has_body:
            raise InputError(
                "This robot is known by its grasps alone, so there is no robot to show",
                where=f"robot={self.robot}",
                fix=f"choose robot=lbr4_allegro, or {gripper}",
            )
        if self.wants_plan and not self.has_palm_poses:
            raise InputError(
                "The viewer plans palm poses, and the grasps of this robot are rectangles in the image",
                where=f"robot={self.robot} with view or weights",
                fix=f"leave them out with weights=null planner=heuristic, or {gripper}",
            )
