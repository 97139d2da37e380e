"""Experiments win over what their command would do by itself."""

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from preshape.paths import project_root


@pytest.mark.parametrize(
    ("command", "experiment", "key", "value"),
    [
        ("train", "paper", "split", "seen"),
        ("train", "paper", "dataset.data.hold_out.validation_fraction", 0),
        ("train", "paper", "run_name", "paper_config_cnn"),
        ("train", "demo", "learning.settings.iterations", 600),
        ("train", "demo", "run_name", "demo_palm_points"),
        ("train", "unseen", "dataset.data.hold_out.split", "objects"),
        ("train", "unseen", "run_name", "unseen_palm_points"),
        ("train", "seen", "run_name", "seen_palm_points"),
        ("train", "seen", "dataset.data.hold_out.split", "scenes"),
        ("evaluate", "planning", "evaluate.poses_per_object", 20),
        ("evaluate", "planning", "run_name", "planning_seen"),
        ("train", "two_finger_unseen", "dataset.data.hold_out.split", "objects"),
        ("train", "two_finger_unseen", "learning.settings.iterations", 6000),
        ("evaluate", "two_finger", "planners.inference.name", "rectangle_inference"),
        ("evaluate", "demo_planning", "run_name", "demo"),
        ("evaluate", "demo_planning", "evaluate.filmed_scenes", 6),
    ],
)
def test_an_experiment_has_the_last_word(command: str, experiment: str, key: str, value: object) -> None:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose(command, [f"experiment={experiment}"])
    assert OmegaConf.select(cfg, key) == value


def test_the_gripper_is_evaluated_on_objects_that_its_network_has_not_seen() -> None:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        held_out = set(compose("train", ["experiment=two_finger_unseen"]).dataset.data.hold_out.objects)
        for chosen in ([], ["condition=tall", "objects=grocery"]):
            cfg = compose("evaluate", ["experiment=two_finger", *chosen])
            assert len(set(cfg.laboratory.scenes.only)) == 10
            assert set(cfg.laboratory.scenes.only) <= held_out
