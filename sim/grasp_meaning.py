"""What theta means to a robot: where its palm goes and how its hand is shaped, and back."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from preshape.data.scene import Scene
from preshape.geometry.pose import invert_pose
from preshape.perception.observation import Observation
from sim.robots.description import RobotDescription
from sim.table import TableSettings


@dataclass(frozen=True, eq=False)
class PlacedGrasp:
    """A theta in a scene as the arm and the hand understand it.

    Args:
        T_world_palm: where the palm is to be.
        preshape: joint positions of the hand (rad or m).
        theta_of: the theta of a palm pose in the world and joint positions of the hand that were reached.
    """

    T_world_palm: Float[np.ndarray, "4 4"]
    preshape: Float[np.ndarray, "h"]
    theta_of: Callable[[Float[np.ndarray, "4 4"], Float[np.ndarray, "h"]], Float[np.ndarray, "d"]]


class GraspMeaning(Protocol):
    """Gives thetas of one grasp space their meaning for one robot."""

    def place(
        self,
        scene: Scene,
        theta: Float[np.ndarray, "d"],
        table: TableSettings,
        look: Callable[[Scene], Observation],
    ) -> PlacedGrasp:
        """Where a theta puts the hand.

        Args:
            scene: the scene.
            theta: the grasp.
            table: which the robot knows.
            look: gives the view of the scene to those who need it.

        Raises:
            InputError: if the view does not say where the grasp is.
        """


@dataclass(frozen=True, eq=False)
class PalmGrasps:
    """Theta is a palm pose in the camera frame with preshape joints.

    Args:
        robot: whose grasp space says so.
    """

    robot: RobotDescription

    def place(
        self,
        scene: Scene,
        theta: Float[np.ndarray, "d"],
        table: TableSettings,
        look: Callable[[Scene], Observation],
    ) -> PlacedGrasp:
        """As theta says; nobody needs to look."""
        robot, space = self.robot, self.robot.grasp_space
        T_world_camera = scene.camera.T_world_camera

        def theta_of(
            T_world_palm: Float[np.ndarray, "4 4"], hand: Float[np.ndarray, "h"]
        ) -> Float[np.ndarray, "d"]:
            return space.theta(invert_pose(T_world_camera) @ T_world_palm, robot.preshape_joints(hand))

        preshape = robot.preshape(space.joints(theta))
        return PlacedGrasp(T_world_camera @ space.palm_pose(theta), preshape, theta_of)
