"""Pinocchio's models of a robot: the whole, and the arm with its hand frozen in a preshape."""

import numpy as np
import pinocchio as pin
from jaxtyping import Float

from preshape.geometry.pose import invert_pose
from sim.robots.description import RobotDescription


class RobotModel:
    """Kinematic tree and collision shapes of a robot. Everything inside is relative to the robot's base.

    Args:
        robot: the robot.
    """

    def __init__(self, robot: RobotDescription) -> None:
        path = str(robot.urdf_path)
        self.robot = robot
        self.whole = pin.buildModelFromUrdf(path)
        self.shapes = pin.buildGeomFromUrdf(self.whole, path, pin.GeometryType.COLLISION)
        self._hand_joints = [self.whole.getJointId(name) for name in robot.hand_joints]

    def whole_positions(
        self, arm: Float[np.ndarray, "a"], hand: Float[np.ndarray, "h"]
    ) -> Float[np.ndarray, "n"]:
        """Joint angles in the order of the whole model."""
        positions = pin.neutral(self.whole)
        angles = dict(zip(self.robot.arm_joints + self.robot.hand_joints, (*arm, *hand), strict=True))
        for name, angle in angles.items():
            positions[self.whole.joints[self.whole.getJointId(name)].idx_q] = angle
        return positions

    def with_frozen_hand(self, hand: Float[np.ndarray, "h"]) -> tuple[pin.Model, pin.GeometryModel]:
        """The arm alone, with the hand as one rigid body in the given joint angles (rad)."""
        at_rest = self.whole_positions(np.zeros(len(self.robot.arm_joints)), hand)
        arm, (shapes,) = pin.buildReducedModel(self.whole, [self.shapes], self._hand_joints, at_rest)
        return arm, shapes


class ArmKinematics:
    """Where the arm's joint angles put the palm.

    Args:
        model: the robot.
    """

    def __init__(self, model: RobotModel) -> None:
        robot = model.robot
        self.lower, self.upper = robot.arm_lower_limits, robot.arm_upper_limits
        self._arm, _ = model.with_frozen_hand(robot.hand_open)
        self._data = self._arm.createData()
        self._palm_link = self._arm.getFrameId(robot.palm_link)
        self._T_world_base = robot.T_world_base
        self._T_base_world = invert_pose(robot.T_world_base)
        self._T_link_palm = robot.T_link_palm
        self._T_palm_link = invert_pose(robot.T_link_palm)

    def palm_pose(self, positions: Float[np.ndarray, "a"]) -> Float[np.ndarray, "4 4"]:
        """T_world_palm at joint angles (rad)."""
        pin.forwardKinematics(self._arm, self._data, positions)
        T_base_link = pin.updateFramePlacement(self._arm, self._data, self._palm_link)
        return self._T_world_base @ T_base_link.homogeneous @ self._T_link_palm

    def link_target(self, T_world_palm: Float[np.ndarray, "4 4"]) -> pin.SE3:
        """The pose of the palm link in the base that puts the palm at a world pose."""
        return pin.SE3(self._T_base_world @ T_world_palm @ self._T_palm_link)

    def error_and_jacobian(
        self, target: pin.SE3, positions: Float[np.ndarray, "a"]
    ) -> tuple[Float[np.ndarray, "6"], Float[np.ndarray, "6 a"]]:
        """Twist (m, rad; palm link's frame) from the palm link to its target, and the Jacobian there."""
        pin.computeJointJacobians(self._arm, self._data, positions)
        T_base_link = pin.updateFramePlacement(self._arm, self._data, self._palm_link)
        error = pin.log6(T_base_link.actInv(target)).vector
        return error, pin.getFrameJacobian(self._arm, self._data, self._palm_link, pin.LOCAL)
