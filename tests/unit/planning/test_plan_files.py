import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from analytic_objectives import quadratic

from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.geometry.pose import make_pose, rotation_from_euler_xyz
from preshape.grasps.rectangle_pose import JawPose
from preshape.grasps.rectangle_space import rectangle_space
from preshape.grasps.space import GraspSpace
from preshape.planning.bounds import Bounds, BoxSize
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import Objective, UnknownSuccess
from preshape.planning.plan_files import read_plan, write_plan
from preshape.planning.planner import Planner

SPACE = GraspSpace.palm_and_joints("test_palm8", {"index_0": (-0.3, 0.28), "thumb_0": (0.3, 1.396)})
FACES = (Face.TOP, Face.SIDE_NEAREST, Face.SIDE_SECOND)


def some_plan(planner: Planner, objective: Objective) -> GraspPlan:
    initial = np.random.default_rng(0).uniform(0.3, 0.4, (3, 8)) * [1, 1, 1, 1, 1, 1, 0.5, 1]
    result = planner.plan(objective, initial, Bounds.around(initial, SPACE, BoxSize()))
    poses = (make_pose(np.diag([1.0, -1.0, -1.0]), np.array([0, 0, height])) for height in (2.0, 1.4))
    return GraspPlan("test", SPACE, FACES, result, *poses)


@pytest.fixture(
    params=[
        (GradientAscent(LineSearch(0.25), max_iterations=5), quadratic(np.linspace(0.2, 0.5, 8), np.ones(8))),
        (HeuristicPlanner(), UnknownSuccess()),
    ],
    ids=["inference", "heuristic without network"],
)
def plan(request: pytest.FixtureRequest) -> GraspPlan:
    return some_plan(*request.param)


def test_a_plan_comes_back_to_the_bit(plan: GraspPlan, tmp_path: Path) -> None:
    write_plan(tmp_path / "plan.json", plan)
    again = read_plan(tmp_path / "plan.json", SPACE)
    assert (again.planner, again.faces) == (plan.planner, plan.faces)
    np.testing.assert_array_equal(again.T_world_camera, plan.T_world_camera)
    assert again.result.path == ()
    kept = replace(plan.result, path=())
    for field in fields(kept):
        was, is_now = getattr(kept, field.name), getattr(again.result, field.name)
        np.testing.assert_array_equal(np.array(was), np.array(is_now), err_msg=field.name)


def test_rectangles_come_back_with_the_gripper(tmp_path: Path) -> None:
    space = rectangle_space("rectangle4")
    initial = np.array([[300.0, 200.0, 0.3, 30.0], [310.0, 220.0, 2.0, 50.0]])
    result = HeuristicPlanner().plan(UnknownSuccess(), initial, Bounds(initial, initial))
    down = make_pose(
        rotation_from_euler_xyz(torch.tensor([0.0, 1.5, 0.3])).numpy(), np.array([0.1, 0.2, 0.9])
    )
    jaws = (JawPose(down, 0.05, 0.03), JawPose(down @ down, 0.07, 0.01))
    plan = GraspPlan("test", space, (Face.TOP,) * 2, result, down, np.eye(4), jaws)
    write_plan(tmp_path / "plan.json", plan)
    again = read_plan(tmp_path / "plan.json", space)
    for own, was in zip(again.jaws, jaws, strict=True):
        assert (own.opening_m, own.advance_m) == (was.opening_m, was.advance_m)
        np.testing.assert_array_equal(own.T_camera_jaws, was.T_camera_jaws)
    np.testing.assert_allclose(again.palm_pose_in_world(1), down @ down @ down)


def test_the_file_says_how_to_grasp_with_the_best_first(tmp_path: Path) -> None:
    plan = some_plan(GradientAscent(LineSearch(0.25)), quadratic(np.linspace(0.2, 0.5, 8), np.ones(8)))
    write_plan(tmp_path / "plan.json", plan)
    content: dict[str, Any] = json.loads((tmp_path / "plan.json").read_text())
    best = content["grasps"][0]
    assert best["success_prob"] == max(grasp["success_prob"] for grasp in content["grasps"])
    assert best["face"] == plan.faces[plan.result.best].value
    assert content["names"] == list(SPACE.names)
    assert content["units"] == list(SPACE.units)
    T_camera_palm = np.array(best["T_camera_palm"])
    np.testing.assert_allclose(T_camera_palm[:3, 3], best["theta"][:3])
    rotation = rotation_from_euler_xyz(torch.tensor(best["theta"][3:6])).numpy()
    np.testing.assert_allclose(T_camera_palm[:3, :3], rotation, atol=1e-6)
    np.testing.assert_allclose(best["T_world_palm"], plan.T_world_camera @ T_camera_palm)
    np.testing.assert_allclose(best["T_table_palm"], plan.T_table_camera @ T_camera_palm)
    assert best["joints"] == dict(zip(SPACE.joint_names, best["theta"][6:], strict=True))


@pytest.mark.parametrize(
    "damage",
    [
        {"format": "preshape-plan/1"},
        {"grasp_space": "rectangle4"},
        {"grasps": []},
        {"grasps": [{"start": 0}]},
        {"grasps": "none"},
        {"T_world_camera": [1, 2, 3]},
        {"evaluations": None},
    ],
    ids=str,
)
def test_a_damaged_plan_is_refused(damage: dict[str, Any], plan: GraspPlan, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(path, plan)
    path.write_text(json.dumps(json.loads(path.read_text()) | damage))
    with pytest.raises(InputError) as refusal:
        read_plan(path, SPACE)
    assert refusal.value.where == str(path)
