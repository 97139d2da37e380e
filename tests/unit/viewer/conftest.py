"""The robot and a server, for the tests of the viewer."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from omegaconf import DictConfig
from viser import ViserServer

import preshape.command_line.entry_point  # noqa: F401 - registers what the configuration refers to
from preshape.paths import project_root
from preshape.viewer.robot_body import Robot
from preshape.viewer.server import ServerSettings, open_server

FEW_STEPS = ("planner.method.max_iterations=4", "planner.method.tolerance=0.0")


@pytest.fixture(scope="session")
def view_config(tmp_path_factory: pytest.TempPathFactory) -> DictConfig:
    """conf/view.yaml with a fresh cache."""
    cache = tmp_path_factory.mktemp("cache")
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        return compose("view", [f"paths.cache={cache}", *FEW_STEPS])


@pytest.fixture(scope="session")
def robot(view_config: DictConfig) -> Robot:
    return instantiate(view_config.robot.description)


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ViserServer]:
    server = open_server(ServerSettings(port=0))
    yield server
    server.stop()
