"""What the tests of real commands share."""

import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401 - registers what the configuration refers to
from preshape.grasps.space import GraspSpace
from preshape.paths import project_root


@pytest.fixture(scope="session")
def allegro_space() -> GraspSpace:
    """The grasp space of the shipped robot."""
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        return instantiate(compose("collect", ["robot=lbr4_allegro"]).robot.grasp_space)
