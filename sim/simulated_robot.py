"""An arm with a hand as a SAPIEN articulation, driven by joint position targets."""

from functools import lru_cache
from pathlib import Path

import numpy as np
import sapien
from jaxtyping import Float
from sapien.wrapper.articulation_builder import ArticulationBuilder
from sapien.wrapper.urdf_loader import URDFLoader

from sim.robots.description import RobotDescription
from sim.scene_systems import has_renderer

IGNORE_EACH_OTHER = 1
"""Bit of SAPIEN's third collision group: shapes that share it do not collide."""
RESTITUTION = 0.0


class SimulatedRobot:
    """A robot in a scene.

    The arm's links, the palm and the first link of each finger do not collide with each other: motions are
    checked for that before they are executed.

    Args:
        scene: the scene to build it in.
        robot: what to build, and its drives.
    """

    def __init__(self, scene: sapien.Scene, robot: RobotDescription) -> None:
        self.robot = robot
        self.articulation = _build(scene, robot, has_renderer(scene))
        active = {joint.name: k for k, joint in enumerate(self.articulation.active_joints)}
        self._arm = [active[name] for name in robot.arm_joints]
        self._hand = [active[name] for name in robot.hand_joints]
        self._set_drives()
        self._palm = self.articulation.find_link_by_name(robot.palm_link)
        self.hand_links = {link.entity for link in self.articulation.links if link.name in robot.hand_links}

    def _set_drives(self) -> None:
        joints, robot = self.articulation.active_joints, self.robot
        for k, torque in zip(self._arm, robot.arm_torque_limits, strict=True):
            joints[k].set_drive_properties(robot.arm_stiffness, robot.arm_damping, torque)
        for k in self._hand:
            joints[k].set_drive_properties(robot.hand_stiffness, robot.hand_damping, robot.hand_torque_limit)
            joints[k].set_armature(np.full(1, robot.hand_armature, np.float32))
        # The real controllers compensate gravity; without it position drives need no integral part.
        for link in self.articulation.links:
            link.disable_gravity = True

    def place(self, arm: Float[np.ndarray, "7"], hand: Float[np.ndarray, "16"]) -> None:
        """Put the robot at joint angles (rad), at rest and with its drives holding it there."""
        positions = self.articulation.qpos
        positions[self._arm], positions[self._hand] = arm, hand
        self.articulation.set_qpos(positions)
        self.articulation.set_qvel(np.zeros_like(positions))
        self.drive_arm(arm, np.zeros_like(arm))
        self.drive_hand(hand)

    def drive_arm(self, positions: Float[np.ndarray, "7"], velocities: Float[np.ndarray, "7"]) -> None:
        """Targets of the arm's drives: joint angles (rad) and velocities (rad/s)."""
        joints = self.articulation.active_joints
        for k, position, velocity in zip(self._arm, positions, velocities, strict=True):
            joints[k].set_drive_target(float(position))
            joints[k].set_drive_velocity_target(float(velocity))

    def drive_hand(self, positions: Float[np.ndarray, "16"]) -> None:
        """Targets of the hand's drives: positions of its joints (rad or m), as many as the robot has."""
        joints = self.articulation.active_joints
        for k, position in zip(self._hand, positions, strict=True):
            joints[k].set_drive_target(float(position))

    @property
    def fingers(self) -> dict[str, tuple[int, ...]]:
        """Finger to the numbers of its joints among the hand's, palm first."""
        numbers = {name: k for k, name in enumerate(self.robot.hand_joints)}
        return {finger: tuple(numbers[j] for j in joints) for finger, joints in self.robot.fingers.items()}

    @property
    def hand_positions(self) -> Float[np.ndarray, "16"]:
        """Measured positions of the hand's joints (rad or m)."""
        return self.articulation.qpos[self._hand].astype(np.float64)

    @property
    def palm_pose(self) -> Float[np.ndarray, "4 4"]:
        """T_world_palm as it is now."""
        return self._palm.entity_pose.to_transformation_matrix().astype(np.float64) @ self.robot.T_link_palm

    @property
    def palm_height_m(self) -> float:
        """Height of the palm frame's origin over the floor as it is now."""
        return float(self.palm_pose[2, 3])

    @property
    def palm_velocity(self) -> Float[np.ndarray, "3"]:
        """Linear velocity of the palm link (m/s, world)."""
        return np.asarray(self._palm.linear_velocity, dtype=np.float64)


def _build(scene: sapien.Scene, robot: RobotDescription, rendered: bool) -> sapien.physx.PhysxArticulation:
    friction = sapien.physx.get_default_material().static_friction
    builder = _parsed_builder(robot.urdf_path, rendered, friction)
    builder.set_scene(scene)
    builder.set_initial_pose(sapien.Pose(robot.T_world_base))
    articulation = builder.build(fix_root_link=True)
    silent = set(robot.arm_links) | set(robot.finger_base_links) | {robot.palm_link}
    for link in articulation.links:
        if link.name in silent:
            for shape in link.collision_shapes:
                groups = shape.get_collision_groups()
                groups[2] |= IGNORE_EACH_OTHER
                shape.set_collision_groups(groups)
    return articulation


@lru_cache(maxsize=4)
def _parsed_builder(urdf_path: Path, rendered: bool, friction: float) -> ArticulationBuilder:
    """Reading the URDF costs more than building from it, so a process reads it once.

    Args:
        urdf_path: the robot.
        rendered: whether it has to be seen.
        friction: of its shapes, static and dynamic.
    """
    loader = URDFLoader()
    loader.set_material(friction, friction, RESTITUTION)
    loader.set_scene(sapien.Scene([sapien.physx.PhysxCpuSystem()]))
    (builder,), _, _ = loader.parse(str(urdf_path))
    if not rendered:
        for link in builder.link_builders:
            link.visual_records.clear()
    return builder
