"""The robot of the configuration, for the tests of the simulator."""

import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from omegaconf import DictConfig

import preshape.command_line.entry_point  # noqa: F401 - registers what the configuration refers to
from preshape.paths import project_root
from sim.robots.description import RobotDescription


@pytest.fixture(scope="session")
def robot_config(tmp_path_factory: pytest.TempPathFactory) -> DictConfig:
    """The configuration of robot=lbr4_allegro with a fresh cache."""
    choices = ["robot=lbr4_allegro", f"paths.cache={tmp_path_factory.mktemp('cache')}"]
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        return compose("collect", choices)


@pytest.fixture(scope="session")
def robot(robot_config: DictConfig) -> RobotDescription:
    """The arm with the hand."""
    return instantiate(robot_config.robot.description)
