"""The viewer of a plan for a saved view; it needs no simulator."""

from functools import partial

import numpy as np
from jaxtyping import Float
from viser import ViserServer

from preshape.geometry.pose import transform_points
from preshape.perception.observation import Observation
from preshape.planning.grasp_plan import GraspPlan
from preshape.viewer.climb_panel import ClimbPanel
from preshape.viewer.grasp_scene import GraspScene
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.robot_body import Robot, RobotBody
from preshape.viewer.trial_stage import PlacedHand


class SavedViewSession:
    """Shows the grasps that were planned for one view.

    Args:
        server: the viewer's server.
        jobs: does what the browser asks for.
        robot: whose palm poses theta gives.
        observation: the view.
        plan: the grasps.
    """

    def __init__(
        self, server: ViserServer, jobs: JobQueue, robot: Robot, observation: Observation, plan: GraspPlan
    ) -> None:
        self._place = partial(placed_palm, robot, plan)
        server.gui.add_markdown(f"**{plan.summary()}**\n\nPlanned by `{plan.planner}` for a saved view.")
        with server.gui.add_folder("Climb of the success probability"):
            self.climb = ClimbPanel(server.gui, jobs, self._show_grasp, from_the_end=True)
        with server.gui.add_folder("Show"):
            self.scene = GraspScene(server, jobs, RobotBody(robot), executes=False)
        self.scene.show_view(observation)
        palms = plan.result.initial_theta[:, :3]
        target = transform_points(plan.T_world_camera, palms.mean(axis=0)[None])[0]
        self.scene.look_at(plan.T_world_camera, target)
        self.climb.show(plan)

    def tick(self) -> None:
        """Nothing moves by itself."""

    def _show_grasp(self) -> None:
        initial, theta = self.climb.initial, self.climb.theta
        if initial is not None and theta is not None:
            self.scene.show_initial(self._place(initial))
            self.scene.show_planned(self._place(theta), distinct=not np.array_equal(initial, theta))


def placed_palm(robot: Robot, plan: GraspPlan, theta: Float[np.ndarray, "d"]) -> PlacedHand:
    """Where a theta that is a palm pose in the camera frame with preshape joints puts the hand."""
    hand = robot.preshape(plan.space.joints(theta))
    T_world_palm = plan.T_world_camera @ plan.space.palm_pose(theta)
    return PlacedHand(T_world_palm, dict(zip(robot.hand_joints, hand.tolist(), strict=True)))
