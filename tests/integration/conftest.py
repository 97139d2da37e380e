"""What the tests of real commands share."""

import pytest
from hydra.utils import instantiate
from omegaconf import OmegaConf

from preshape.grasps.space import GraspSpace
from preshape.paths import project_root


@pytest.fixture(scope="session")
def allegro_space() -> GraspSpace:
    """The grasp space of the shipped robot."""
    robot = OmegaConf.load(project_root() / "conf" / "robot" / "lbr4_allegro.yaml")
    return instantiate(robot.grasp_space)
