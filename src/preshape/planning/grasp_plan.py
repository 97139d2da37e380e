"""The grasps planned for one view."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from preshape.data.trial import Face
from preshape.grasps.rectangle_pose import JawPose
from preshape.grasps.space import GraspSpace
from preshape.planning.result import PlanResult


@dataclass(frozen=True, eq=False)
class GraspPlan:
    """What a planner found for one view, with all that is needed to execute it.

    Args:
        planner: name of the planner.
        space: grasp space of theta.
        faces: face of the bounding box that each start aimed at; decides how the hand closes.
        result: the grasps: palm poses in the camera frame with joints, or rectangles in the image.
        T_world_camera: pose of the camera.
        T_table_camera: pose of the camera over the table that it sees: z up from the table's top, the origin
            under the camera, x along the image's right.
        jaws: where rectangles put the gripper, one for each; empty for palm poses, which say it themselves.
    """

    planner: str
    space: GraspSpace
    faces: tuple[Face, ...]
    result: PlanResult
    T_world_camera: Float[np.ndarray, "4 4"]
    T_table_camera: Float[np.ndarray, "4 4"]
    jaws: tuple[JawPose, ...] = ()

    def palm_pose(self, start: int) -> Float[np.ndarray, "4 4"]:
        """T_camera_palm of a planned grasp."""
        if self.jaws:
            return self.jaws[start].T_camera_jaws
        return self.space.palm_pose(self.result.theta[start])

    def palm_pose_in_world(self, start: int) -> Float[np.ndarray, "4 4"]:
        """T_world_palm of a planned grasp."""
        pose: Float[np.ndarray, "4 4"] = self.T_world_camera @ self.palm_pose(start)
        return pose

    def palm_pose_over_table(self, start: int) -> Float[np.ndarray, "4 4"]:
        """T_table_palm of a planned grasp."""
        pose: Float[np.ndarray, "4 4"] = self.T_table_camera @ self.palm_pose(start)
        return pose

    def summary(self) -> str:
        """The grasp to try first, in one line."""
        best = self.result.best
        face = self.faces[best].value.replace("_", " ")
        before, after = self.result.initial_success_prob[best], self.result.success_prob[best]
        if np.isnan(after):
            return f"First of {len(self.faces)} grasps: {face}, its success is unknown without a network"
        return f"Best of {len(self.faces)} grasps: {face}, p(success) {after:.3f} (initially {before:.3f})"
