from typing import Any

import numpy as np
import pytest
import torch

from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.grasps.heuristic import HeuristicSettings
from preshape.grasps.space import GraspSpace
from preshape.models.config_cnn import ConfigCNN
from preshape.perception.observation import Observation
from preshape.planning.bounds import BoxSize
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.line_search import LineSearch
from preshape.planning.planner import Planner
from preshape.planning.view_planner import ViewPlanner

JOINTS = [f"{finger}_{joint}" for finger in ("index", "middle", "ring", "thumb") for joint in (0, 1)]
SPACE = GraspSpace.palm_and_joints("test", dict.fromkeys(JOINTS, (-0.3, 0.4)))


def view_planner(method: Planner, model: ConfigCNN | None) -> ViewPlanner:
    heuristic = HeuristicSettings(joint_ranges=dict.fromkeys(JOINTS, (-0.1, 0.2)))
    return ViewPlanner("test", method, BoxSize(), SPACE, heuristic, model)


@pytest.fixture(scope="module")
def observation(table_top: Any) -> Observation:
    return table_top.view(table_top.box((0.08, 0.06, 0.16), yaw=0.5), noise_seed=0)


def test_inference_improves_on_the_heuristic_of_the_same_view(observation: Observation) -> None:
    torch.manual_seed(0)
    ascent = GradientAscent(LineSearch(first_step=0.25), max_iterations=5)
    planner = view_planner(ascent, ConfigCNN("config_cnn", SPACE.name, SPACE.dim))
    plan = planner.plan(observation, np.random.default_rng(1))
    assert plan.faces == (Face.TOP, Face.SIDE_NEAREST, Face.SIDE_SECOND)
    assert (plan.result.success_prob > plan.result.initial_success_prob).all()
    moved = np.abs(plan.result.theta - plan.result.initial_theta)
    assert (moved[:, :3] <= 0.05 + 1e-12).all()
    assert (moved[:, 3:6] <= 0.157 + 1e-12).all()
    # The preshapes of the heuristic, which are narrower than the hand's limits.
    assert (plan.result.theta[:, 6:] >= -0.1).all()
    assert (plan.result.theta[:, 6:] <= 0.2).all()


def test_the_heuristic_needs_no_network(observation: Observation) -> None:
    plan = view_planner(HeuristicPlanner(), None).plan(observation, np.random.default_rng(1))
    again = view_planner(HeuristicPlanner(), None).plan(observation, np.random.default_rng(1))
    np.testing.assert_array_equal(plan.result.theta, again.result.theta)
    np.testing.assert_allclose(plan.palm_pose_in_world(0)[:2, 3], [0.8, 0.0], atol=0.02)


def test_a_view_without_object_is_refused(table_top: Any) -> None:
    with pytest.raises(InputError, match="No object"):
        view_planner(HeuristicPlanner(), None).plan(table_top.view(), np.random.default_rng(0))
