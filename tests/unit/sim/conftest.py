"""The robot of the configuration, for the tests of the simulator."""

from pathlib import Path

import pytest
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from sim.robots.description import RobotDescription

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def robot_config(tmp_path_factory: pytest.TempPathFactory) -> DictConfig:
    """conf/robot/lbr4_allegro.yaml with a fresh cache."""
    robot = OmegaConf.load(ROOT / "conf" / "robot" / "lbr4_allegro.yaml")
    return OmegaConf.create({"robot": robot, "paths": {"cache": str(tmp_path_factory.mktemp("cache"))}})


@pytest.fixture(scope="session")
def robot(robot_config: DictConfig) -> RobotDescription:
    """The arm with the hand."""
    return instantiate(robot_config.robot.description)
