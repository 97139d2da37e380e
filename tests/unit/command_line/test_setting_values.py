"""Values of the wrong kind and counts that cannot be are refused; whatever the project ships passes."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from hydra.core.hydra_config import HydraConfig
from omegaconf import OmegaConf

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from preshape.command_line.setting_values import check_values
from preshape.errors import InputError

CONF = Path(__file__).parents[3] / "conf"


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("collect.trials=many", "a whole number from 1 on"),
        ("collect.trials=0", "a whole number from 1 on"),
        ("collect.trials=null", "a whole number from 1 on"),
        ("collect.trials=1.5", "a whole number from 1 on"),
        ("collect.workers=true", "a whole number from 1 on"),
        ("collect.output=null", "a path"),
        ("report.effort=null", "a path"),
        ("report.record=null", "a path"),
        ("runs=null", "a path"),
        ("planners.inference.method=null", "conf/"),
        ("dataset.data.folder=null", "a path"),
        ("view=7", "./7"),
        ("schedule=none", "one_cycle"),
        ("validation_fraction=2", "from 0 to below 1"),
        ("collect.scene_limit_s=-1", "a number greater than 0"),
        ("objects.set.density=-1", "a number that is not negative"),
        ("objects.set.friction=.inf", "a number that is not negative"),
    ],
)
def test_a_value_that_cannot_be_is_named_with_what_can(setting: str, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        check_values(OmegaConf.from_dotlist([setting]))
    assert refusal.value.where.startswith(setting.split("=")[0])
    assert message in refusal.value.fix


@pytest.mark.parametrize(
    "setting",
    [
        "collect.workers=null",
        "objects.set.density=null",
        "dataset.data.trials=null",
        "trials=[1,2]",
        "report.runs=null",
    ],
)
def test_what_may_be_null_or_a_list_passes(setting: str) -> None:
    check_values(OmegaConf.from_dotlist([setting]))


def test_every_shipped_value_passes() -> None:
    for path in CONF.rglob("*.yaml"):
        content = OmegaConf.load(path)
        content.pop("hydra", None)
        check_values(content)


@pytest.fixture
def check() -> Iterator[Callable[..., None]]:
    """Check the values of a command, as the command itself does."""

    def check(command: str, *overrides: str) -> None:
        with initialize_config_dir(str(CONF), version_base="1.3"):
            cfg = compose(command, list(overrides), return_hydra_config=True)
            HydraConfig.instance().set_config(cfg)
            check_values(compose(command, list(overrides)))

    yield check
    HydraConfig.instance().cfg = None


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("robot.heuristic.top_offset_m=far", "a number"),
        ("robot.grasp_space.joint_limits.index_0=7", "a list in brackets"),
        ("dataset.data.added=yes", "a list in brackets"),
        ("robot.grasp_space.joint_limits.index_0=[0,x]", "a list in which each is a number"),
    ],
)
def test_a_value_of_another_kind_is_refused(check, setting: str, message: str) -> None:
    with pytest.raises(InputError, match=setting.split("=")[0]) as refusal:
        check("fit_prior", "camera=kinect_ideal", setting)
    assert message in refusal.value.fix


def test_what_has_to_be_given_cannot_be_null(check) -> None:
    with pytest.raises(InputError, match="weights cannot be null"):
        check("export", "weights=null")


def test_values_of_the_same_kind_and_choices_pass(check) -> None:
    check("fit_prior", "prior=network", "robot.heuristic.top_offset_m=1", "~dataset.data.added", "+note=x")
