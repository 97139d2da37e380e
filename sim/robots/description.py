"""What the simulator and the arm's planner need to know about a robot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from preshape.grasps.space import GraspSpace


@dataclass(frozen=True)
class RobotSettings:
    """Choices about an arm with a hand (`conf/robot/`).

    Where a hand's joints slide, read m for rad and N for Nm.

    Args:
        name: name of the robot, as trial tables record it.
        base_height_m: height of the arm's base plate over the floor; a pedestal fills the gap.
        mount_length_m: length of the piece between the arm's flange and the hand.
        mount_yaw_rad: turn of the hand about the flange's axis.
        palm_offset_m: origin of the palm frame in the frame of the palm link.
        preshape_mapping: joint of the grasp space -> joint of the URDF that it sets.
        arm_home_rad: arm joints at rest, out of the camera's view and away from the table.
        hand_open_rad: the hand's joints that are not at zero when it is open, by URDF name.
        arm_accelerations: acceleration limit of each arm joint (rad/s^2).
        arm_stiffness, arm_damping: drive gains of the arm (Nm/rad, Nm s/rad).
        hand_stiffness, hand_damping: drive gains of the hand (Nm/rad, Nm s/rad).
        hand_torque_limit: largest torque of a finger joint (Nm).
        hand_armature: inertia that its motor adds to each finger joint (kg m^2).
    """

    name: str
    base_height_m: float
    mount_length_m: float
    mount_yaw_rad: float
    palm_offset_m: Sequence[float]
    preshape_mapping: Mapping[str, str]
    arm_home_rad: Sequence[float]
    hand_open_rad: Mapping[str, float]
    arm_accelerations: Sequence[float]
    arm_stiffness: float
    arm_damping: float
    hand_stiffness: float
    hand_damping: float
    hand_torque_limit: float
    hand_armature: float


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """A robot put together: one URDF and the meaning of its joints and links.

    Where a hand's joints slide, read m for rad and N for Nm.

    Args:
        name: name of the robot, as trial tables record it.
        urdf_path: arm, mount and hand in one file; meshes by absolute path.
        grasp_space: the grasp space that the preshape belongs to.
        arm_joints: joints of the arm from its base to its flange.
        hand_joints: joints of the hand in the order of the URDF.
        fingers: finger -> its joints from the palm to the tip.
        fingertip_links: finger -> the link at its tip.
        palm_link: the link that carries the palm frame.
        arm_links: links of the arm and the mount.
        hand_links: the palm and all links of the fingers.
        finger_base_links: first link of each finger; it may touch the palm.
        disabled_pairs: pairs of links that are not checked for collisions.
        preshape_mapping: joint of the grasp space -> joint of the URDF that it sets.
        T_world_base: pose of the URDF's root link.
        T_link_palm: palm frame (x: the approach, into the object; y: the thumb's side and z: along the middle
            finger, or y: along a gripper's opening) in the palm link.
        arm_home, hand_open: joint angles (rad) at rest.
        arm_lower_limits, arm_upper_limits, hand_lower_limits, hand_upper_limits: joint limits (rad).
        arm_velocities, arm_accelerations: the arm's largest speeds (rad/s) and accelerations (rad/s^2).
        arm_torque_limits, hand_torque_limit: largest torques (Nm): per arm joint, and of any finger joint.
        arm_stiffness, arm_damping, hand_stiffness, hand_damping: drive gains (Nm/rad, Nm s/rad).
        hand_armature: inertia that its motor adds to each finger joint (kg m^2).
    """

    name: str
    urdf_path: Path
    grasp_space: GraspSpace
    arm_joints: tuple[str, ...]
    hand_joints: tuple[str, ...]
    fingers: dict[str, tuple[str, ...]]
    fingertip_links: dict[str, str]
    palm_link: str
    arm_links: tuple[str, ...]
    hand_links: tuple[str, ...]
    finger_base_links: tuple[str, ...]
    disabled_pairs: tuple[tuple[str, str], ...]
    preshape_mapping: dict[str, str]
    T_world_base: Float[np.ndarray, "4 4"]
    T_link_palm: Float[np.ndarray, "4 4"]
    arm_home: Float[np.ndarray, "a"]
    hand_open: Float[np.ndarray, "h"]
    arm_lower_limits: Float[np.ndarray, "a"]
    arm_upper_limits: Float[np.ndarray, "a"]
    arm_velocities: Float[np.ndarray, "a"]
    arm_accelerations: Float[np.ndarray, "a"]
    hand_lower_limits: Float[np.ndarray, "h"]
    hand_upper_limits: Float[np.ndarray, "h"]
    arm_torque_limits: Float[np.ndarray, "a"]
    hand_torque_limit: float
    arm_stiffness: float
    arm_damping: float
    hand_stiffness: float
    hand_damping: float
    hand_armature: float

    def preshape(self, joints: Float[np.ndarray, "j"]) -> Float[np.ndarray, "h"]:
        """All joint angles of the hand (rad) for the preshape joints of theta; the others are zero.

        Everything is clipped to the hand's limits.
        """
        angles = np.zeros(len(self.hand_joints))
        for name, angle in zip(self.grasp_space.joint_names, joints, strict=True):
            angles[self.hand_joints.index(self.preshape_mapping[name])] = angle
        return np.clip(angles, self.hand_lower_limits, self.hand_upper_limits)

    def preshape_joints(self, hand: Float[np.ndarray, "h"]) -> Float[np.ndarray, "j"]:
        """The preshape joints of theta (rad) among all joint angles of the hand."""
        names = (self.preshape_mapping[name] for name in self.grasp_space.joint_names)
        return np.array([hand[self.hand_joints.index(name)] for name in names])
