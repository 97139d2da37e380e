"""A plan for a saved view, as the browser is shown it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from omegaconf import DictConfig
from viser import ViserServer

from preshape.configured_planner import planner_of
from preshape.geometry.pose import pose_from_quaternion
from preshape.hands.allegro import allegro_hand
from preshape.models.palm_points import PalmPoints
from preshape.perception.observation import Observation
from preshape.planning.grasp_plan import GraspPlan
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.robot_body import Robot
from preshape.viewer.robot_figure import RobotFigure
from preshape.viewer.saved_view_session import SavedViewSession

TIPS = ("link_3.0_tip", "link_7.0_tip", "link_11.0_tip", "link_15.0_tip")


@pytest.fixture(scope="module")
def observation(table_top: Any) -> Observation:
    return table_top.view(table_top.box((0.08, 0.06, 0.16), yaw=0.5))


@pytest.fixture(scope="module")
def plan(view_config: DictConfig, observation: Observation) -> GraspPlan:
    torch.manual_seed(0)
    planner = planner_of(view_config)
    network = PalmPoints("palm_points", "allegro_palm14", 14, points=16, width=4)
    return replace(planner, model=network).plan(observation, np.random.default_rng(0))


def node_poses(figure: RobotFigure) -> dict[str, np.ndarray]:
    return {name: pose_from_quaternion(node.position, node.wxyz) for name, node in figure.nodes.items()}


def assert_hand_is_at(figure: RobotFigure, theta: np.ndarray, T_world_camera: np.ndarray) -> None:
    """Compare with the project's own kinematics, which draw with another library than the viewer."""
    hand, batch, poses = allegro_hand(), torch.from_numpy(theta)[None], node_poses(figure)
    palm = hand.palm_link_pose(batch)[0].numpy()
    np.testing.assert_allclose(poses["palm_link_0"], T_world_camera @ palm, atol=1e-6)
    for tip, chain in zip(TIPS, hand.link_poses(batch)[0].numpy(), strict=True):
        np.testing.assert_allclose(poses[f"{tip}_0"], T_world_camera @ chain[-1], atol=1e-6)


def test_the_slider_moves_the_hand_along_the_climb(
    server: ViserServer, robot: Robot, observation: Observation, plan: GraspPlan
) -> None:
    jobs = JobQueue()
    session = SavedViewSession(server, jobs, robot, observation, plan)
    jobs.work_off()
    best, T_world_camera = plan.result.best, observation.camera.T_world_camera
    steps = len(plan.result.climb[best]) - 1
    assert steps > 1
    assert session.climb.step.value == session.climb.step.max == steps
    assert_hand_is_at(session.scene.planned, plan.result.theta[best], T_world_camera)
    assert_hand_is_at(session.scene.initial, plan.result.initial_theta[best], T_world_camera)
    for step in (1, 0):
        set_value(session.climb.step, step)
        jobs.work_off()
        assert_hand_is_at(session.scene.planned, plan.result.path[best][step], T_world_camera)
        assert session.climb.success_prob == plan.result.climb[best][step]
        x, probs, mark = session.climb.plot.data
        np.testing.assert_array_equal(probs, plan.result.climb[best])
        assert (np.isfinite(mark) == (x == step)).all()
    # at the beginning, both hands are in the same place
    assert session.scene.initial.visible
    assert not session.scene.planned.visible


def test_every_start_can_be_chosen_and_hidden(
    server: ViserServer, robot: Robot, observation: Observation, plan: GraspPlan
) -> None:
    jobs = JobQueue()
    session = SavedViewSession(server, jobs, robot, observation, plan)
    jobs.work_off()
    assert len(session.climb.start.options) == len(plan.faces)
    set_value(session.climb.start, session.climb.start.options[-1])
    jobs.work_off()
    last = int(plan.result.ranking[-1])
    assert_hand_is_at(session.scene.planned, plan.result.theta[last], observation.camera.T_world_camera)
    assert session.scene.planned.visible
    set_value(session.scene.switches["planned grasp (blue)"], False)
    jobs.work_off()
    assert not session.scene.planned.visible


def test_the_view_is_shown_where_it_is(
    server: ViserServer, robot: Robot, observation: Observation, plan: GraspPlan
) -> None:
    session = SavedViewSession(server, JobQueue(), robot, observation, plan)
    cloud, camera = session.scene.view.cloud, session.scene.view.camera
    assert cloud is not None
    assert camera is not None
    assert cloud.points.shape == cloud.colors.shape == (np.isfinite(observation.depth).sum(), 3)
    assert cloud.points[:, 2].max() == pytest.approx(0.59 + 0.16, abs=0.005)  # the top of the box
    pose = pose_from_quaternion(camera.position, camera.wxyz)
    np.testing.assert_allclose(pose, observation.camera.T_world_camera, atol=1e-9)
    assert camera.aspect == pytest.approx(4 / 3)
