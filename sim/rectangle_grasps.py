"""Grasp rectangles as a two-finger gripper understands them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from preshape.cornell.rectangle import GraspRectangle
from preshape.data.scene import Scene
from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose
from preshape.grasps.rectangle_pose import JawPose, RectanglePoseSettings, jaw_pose, rectangle_of
from preshape.perception.observation import Observation
from sim.grasp_meaning import PlacedGrasp
from sim.robots.parallel_gripper import ParallelGripper
from sim.table import TableSettings

HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])
"""About the approach: a gripper of two equal fingers is the same after it."""


@dataclass(frozen=True, eq=False)
class RectangleGrasps:
    """Theta is a grasp rectangle in the view: centre (px), angle (rad), opening (px).

    What the gripper cannot open so far, or so little, it opens as far as it can.

    Args:
        gripper: its opening and its joints.
        pose: how it is put at a rectangle.
        jaw_px: width of the jaws that rectangles have in the image.
    """

    gripper: ParallelGripper
    pose: RectanglePoseSettings
    jaw_px: float

    def place(
        self,
        scene: Scene,
        theta: Float[np.ndarray, "4"],
        table: TableSettings,
        look: Callable[[Scene], Observation],
    ) -> PlacedGrasp:
        """The gripper at the surface point under the rectangle's centre."""
        camera = scene.camera
        rectangle = GraspRectangle(*theta.tolist(), self.jaw_px)
        jaws = jaw_pose(rectangle, look(scene), _plane(camera, table.top_m), self.pose)
        palm = camera.T_world_camera @ jaws.T_camera_jaws
        # of the two half turns the one in which the wrist is less far from its middle
        palm = palm if palm[1, 1] >= 0 else palm @ HALF_TURN

        def theta_of(
            T_world_palm: Float[np.ndarray, "4 4"], hand: Float[np.ndarray, "2"]
        ) -> Float[np.ndarray, "4"]:
            opening_m = self.gripper.opening(float(hand.mean()))
            T_camera_palm = invert_pose(camera.T_world_camera) @ T_world_palm
            reached = rectangle_of(JawPose(T_camera_palm, opening_m, jaws.advance_m), camera, self.jaw_px)
            return np.array([reached.u, reached.v, reached.angle_rad, reached.opening_px])

        return PlacedGrasp(palm, np.full(2, self.gripper.closed_by(jaws.opening_m)), theta_of)

    def commanded(
        self, scene: Scene, rectangle: GraspRectangle, table: TableSettings, view: Observation
    ) -> GraspRectangle:
        """What the gripper is told at a rectangle: the same, opened as far as it can.

        Raises:
            InputError: if the view has no depth at all.
        """
        theta = np.array([rectangle.u, rectangle.v, rectangle.angle_rad, rectangle.opening_px])
        placed = self.place(scene, theta, table, lambda _: view)
        told = placed.theta_of(placed.T_world_palm, placed.preshape)
        return GraspRectangle(*told.tolist(), rectangle.jaw_px)


def _plane(camera: Camera, height_m: float) -> Float[np.ndarray, "4"]:
    """The horizontal plane at a height in the world, in the camera frame."""
    up, origin = camera.T_world_camera[2, :3], camera.T_world_camera[2, 3]
    return np.append(up, origin - height_m)
