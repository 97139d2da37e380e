"""Choices that do not fit together are refused, and named."""

from pathlib import Path
from typing import Any

import pytest
from omegaconf import OmegaConf

from preshape.command_line.composition import check_composition
from preshape.errors import InputError

ROBOT = {
    "name": "lbr4_allegro",
    "grasp_space": {"name": "allegro_palm14", "joint_limits": {f"joint_{i}": [0.0, 1.0] for i in range(8)}},
}
CLIMBING = {"name": "inference", "needs_model": True}


def check(**parts: Any) -> None:
    check_composition(OmegaConf.create(parts))


def test_what_fits_passes(tmp_path: Path) -> None:
    weights = tmp_path / "weights.safetensors"
    weights.touch()
    check(
        robot=ROBOT,
        model={"name": "config_cnn", "grasp_space": "allegro_palm14"},
        dataset={"name": "allegro_grocery", "robot": "lbr4_allegro"},
        planner=CLIMBING,
        planners={"heuristic": {"needs_model": False}, "inference": CLIMBING},
        weights=str(weights),
    )


@pytest.mark.parametrize("parts", [{}, {"robot": ROBOT}, {"planner": {"name": "heuristic"}}, {"robot": None}])
def test_parts_that_are_not_there_are_not_checked(parts: dict[str, Any]) -> None:
    check(**parts)


def test_model_for_another_grasp_space_is_refused() -> None:
    with pytest.raises(InputError) as refusal:
        check(robot=ROBOT, model={"name": "grasp_cnn", "grasp_space": "rectangle4"})
    assert refusal.value.what == (
        "robot=lbr4_allegro has grasp space allegro_palm14 (14 parameters), "
        "but model=grasp_cnn is built for rectangle4"
    )


def test_a_model_that_no_planner_asks_may_be_for_another_grasp_space() -> None:
    other = {"name": "config_cnn", "grasp_space": "rectangle4"}
    check(robot=ROBOT, model=other, planner={"name": "heuristic", "needs_model": False})


def test_trials_of_another_robot_are_refused() -> None:
    with pytest.raises(InputError, match="dataset=two_finger holds trials of robot baxter") as refusal:
        check(robot=ROBOT, dataset={"name": "two_finger", "robot": "baxter"})
    assert "robot=lbr4_allegro" in refusal.value.where


def test_a_robot_without_an_arm_executes_nothing() -> None:
    armless = {"name": "two_finger", "description": None}
    check(robot=armless)
    with pytest.raises(InputError, match="robot=two_finger has no arm") as refusal:
        check(robot=armless, laboratory={"space": None})
    assert "robot=baxter" in refusal.value.fix


@pytest.mark.parametrize("parts", [{"planner": CLIMBING}, {"planners": {"inference": CLIMBING}}])
def test_climbing_needs_a_network(parts: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"inference climbs .* weights is not set"):
        check(**parts, weights=None)
    with pytest.raises(InputError, match="does not exist"):
        check(**parts, weights=str(tmp_path / "weights.safetensors"))


def test_missing_values_are_named_together() -> None:
    objects = {"name": "mesh_folder", "root": "???", "set": {"root": "${objects.root}"}}
    with pytest.raises(InputError, match=r"objects\.root") as refusal:
        check(objects=objects, weights="???")
    assert refusal.value.where == "objects=mesh_folder, weights"
    assert "objects.root=... weights=..." in refusal.value.fix
