"""The hand's clearance, against a box on a table whose place is known."""

from typing import Any

import numpy as np
import pytest

from preshape.geometry.pose import invert_pose, make_pose
from preshape.grasps.space import GraspSpace
from preshape.hands.allegro import allegro_volume
from preshape.perception.segmentation import SegmentationSettings, SegmentedObject, segment
from preshape.planning.hand_clearance import HandClearance, ViewClearance
from preshape.planning.object_solid import ObjectSolid, SolidSettings

SPACE = GraspSpace.palm_and_joints("test", {f"joint_{k}": (-2.0, 2.0) for k in range(8)})
SIZE = np.array([0.08, 0.06, 0.16])
APPROACH_M = 0.1
WRIST = [[0.0, 0.0, -0.253, 0.08]]


@pytest.fixture(scope="module")
def segmented(table_top: Any) -> SegmentedObject:
    return segment(table_top.view(table_top.box(SIZE)), SegmentationSettings())


@pytest.fixture(scope="module")
def clearance(segmented: SegmentedObject) -> ViewClearance:
    return HandClearance(allegro_volume(), 0.0, 0.0, 0.0, APPROACH_M, WRIST).in_view(segmented)


def side_grasp(table_top: Any, distance: float, height: float, tilt: float = 0.0) -> np.ndarray:
    """Theta of a flat hand with its palm at a distance from the box, the thumb up, approaching along x."""
    turn = np.array([[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])
    axes = turn @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x forward, y up, z to the right
    palm = np.array([0.8 - SIZE[0] / 2 - distance, 0.0, table_top.height_m + height])
    T_camera_palm = invert_pose(table_top.camera.T_world_camera) @ make_pose(axes, palm)
    return SPACE.theta(T_camera_palm, np.zeros(8))[None]


def parts(clearance: ViewClearance, theta: np.ndarray) -> tuple[float, float, float, float]:
    """Least slack over the table and from the object, at the grasp and before the approach."""
    values = clearance.slack(theta).values[0]
    own = len(allegro_volume().radii)
    heights, distances = values[: 2 * (own + 1)].reshape(2, -1), values[2 * (own + 1) :].reshape(2, -1)
    return heights[0].min(), heights[1].min(), distances[0].min(), distances[1].min()


def test_distances_are_those_of_the_box_seen_and_unseen(table_top: Any, segmented: SegmentedObject) -> None:
    world = np.array(
        [[0.7, 0, 0.67], [0.9, 0, 0.67], [0.8, 0.05, 0.67], [0.8, 0, 0.77], [0.8, 0, 0.6], [0.8, 0.02, 0.67]]
    )
    T_camera_world = invert_pose(table_top.camera.T_world_camera)
    points = world @ T_camera_world[:3, :3].T + T_camera_world[:3, 3]
    found = ObjectSolid(segmented, SolidSettings(padding_m=0.08)).distance(points[None], np.full(6, 0.05))[0]
    np.testing.assert_allclose(found, [0.05, 0.05, 0.02, 0.02, -0.03, -0.01], atol=0.006)


def test_a_flat_hand_before_the_box_is_as_far_as_its_palm(table_top: Any, clearance: ViewClearance) -> None:
    """One centimetre farther away is one centimetre of clearance more, up to where distances are known."""
    near, far = (parts(clearance, side_grasp(table_top, d, 0.12)) for d in (0.0, 0.01))
    assert far[2] - near[2] == pytest.approx(0.01, abs=0.004)
    assert near[0] == pytest.approx(near[1], abs=1e-4)
    inside = parts(clearance, side_grasp(table_top, -0.02, 0.12))
    assert inside[2] < -0.02
    assert inside[3] == pytest.approx(0.01)


def test_the_table_counts_at_both_ends_of_the_approach(table_top: Any, clearance: ViewClearance) -> None:
    level, tilted = (parts(clearance, side_grasp(table_top, 0.05, 0.1, tilt)) for tilt in (0.0, -0.3))
    assert level[1] == pytest.approx(level[0], abs=2e-3)
    assert tilted[1] - tilted[0] == pytest.approx(-APPROACH_M * np.sin(0.3), abs=2e-3)
    low = parts(clearance, side_grasp(table_top, 0.05, 0.02))
    assert low[0] == pytest.approx(level[0] - 0.08, abs=2e-3)


def test_its_gradient_agrees_with_finite_differences(table_top: Any, clearance: ViewClearance) -> None:
    rng = np.random.default_rng(0)
    theta = np.concatenate([side_grasp(table_top, 0.03, 0.1), side_grasp(table_top, -0.01, 0.08, 0.2)])
    theta[:, 6:] = rng.uniform(-0.4, 0.9, (2, 8))
    slack = clearance.slack(theta)
    weights = rng.normal(size=slack.values.shape)
    gradient = slack.pull_back(weights)
    for parameter in range(14):
        offset = np.zeros(14)
        offset[parameter] = 1e-6
        difference = clearance.slack(theta + offset).values - clearance.slack(theta - offset).values
        expected = (difference * weights).sum(axis=1) / 2e-6
        np.testing.assert_allclose(gradient[:, parameter], expected, rtol=1e-4, atol=1e-4)
