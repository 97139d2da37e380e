"""A KUKA LBR4+ arm with Baxter's parallel gripper: the paper's two-finger gripper on its other arm."""

from pathlib import Path

from preshape.grasps.space import GraspSpace
from sim.robots.description import RobotDescription, RobotSettings
from sim.robots.lbr4_arm import arm_with_hand
from sim.robots.parallel_gripper import ParallelGripper


def load_robot(
    settings: RobotSettings, gripper: ParallelGripper, grasp_space: GraspSpace, cache: str | Path
) -> RobotDescription:
    """Put arm, mount and gripper together; see `arm_with_hand`.

    Args:
        settings: choices about the robot; `palm_offset_m` is the point between the fingers' ends.
        gripper: how the gripper is set up.
        grasp_space: the grasp space, without preshape joints.
        cache: folder for derived files.

    Raises:
        InputError: if the settings do not fit the robot, or `cache` cannot be written to.
    """
    return arm_with_hand(settings, gripper.hand(), grasp_space, cache)
