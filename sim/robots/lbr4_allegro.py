"""A KUKA LBR4+ arm with a right Allegro hand (paper, section 4.1)."""

from pathlib import Path

from preshape.grasps.space import GraspSpace
from sim.robots.allegro import allegro_hand
from sim.robots.description import RobotDescription, RobotSettings
from sim.robots.lbr4_arm import arm_with_hand


def load_robot(settings: RobotSettings, grasp_space: GraspSpace, cache: str | Path) -> RobotDescription:
    """Put arm, mount and hand together; see `arm_with_hand`.

    Args:
        settings: choices about the robot.
        grasp_space: the grasp space of its preshape joints.
        cache: folder for derived files.

    Raises:
        InputError: if the hand's model is missing, the settings do not fit the robot, or `cache` cannot be
            written to.
    """
    return arm_with_hand(settings, allegro_hand(settings.hand_torque_limit), grasp_space, cache)
