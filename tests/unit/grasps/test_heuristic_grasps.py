"""Heuristic palm poses: they face their face at the offset, thumb up, over the table and within limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, make_pose
from preshape.grasps.heuristic import HeuristicSettings, heuristic_grasps, visible_sides
from preshape.grasps.space import GraspSpace
from preshape.perception.segmentation import SegmentedObject

LIMITS = {"finger_0": (-0.47, 0.47), "finger_1": (-0.196, 0.2), "thumb_0": (0.263, 1.396)}
RANGES = {"finger_0": (-0.3, 0.28), "finger_1": (-0.296, 0.207), "thumb_0": (1.396, 1.396)}
SPACE = GraspSpace.palm_and_joints("test", LIMITS)
CAMERA = Camera.looking_at(
    np.array([0.8, -0.9, 1.25]), np.array([0.8, 0.0, 0.65]), width=640, height=480, focal=525.0
)
TABLE_Z = 0.59
EXACT = HeuristicSettings(RANGES, offset_noise_m=0.0, axis_noise_rad=0.0)


def standing_box(extents: tuple[float, float, float], yaw: float) -> SegmentedObject:
    """What segmentation gives for a box at the table's centre."""
    T_world_box = make_pose(
        Rotation.from_euler("z", yaw).as_matrix(), np.array([0.8, 0.0, TABLE_Z + extents[2] / 2])
    )
    T_camera_box = invert_pose(CAMERA.T_world_camera) @ T_world_box
    normal = T_camera_box[:3, 2]
    bottom = T_camera_box[:3, 3] - normal * extents[2] / 2
    empty = np.zeros((480, 640), dtype=bool)
    plane = np.append(normal, -normal @ bottom)
    return SegmentedObject(np.zeros((0, 3)), empty, plane, T_camera_box, np.array(extents))


boxes = st.builds(
    standing_box,
    st.tuples(st.floats(0.05, 0.25), st.floats(0.03, 0.15), st.floats(0.015, 0.3)),
    st.floats(0, 6.3),
)
seeds = st.integers(0, 2**32 - 1)


@given(boxes, seeds)
@hypothesis_settings(deadline=None, max_examples=50)
def test_palms_face_their_faces(box: SegmentedObject, seed: int) -> None:
    rotation, centre = box.T_camera_box[:3, :3], box.T_camera_box[:3, 3]
    for grasp in heuristic_grasps(box, SPACE, EXACT, CAMERA, np.random.default_rng(seed)):
        palm = SPACE.palm_pose(grasp.theta)
        outward = -palm[:3, 0]
        along = rotation.T @ outward  # a unit vector along one axis of the box
        assert np.isclose(np.abs(along).max(), 1.0)
        offset = EXACT.top_offset_m if grasp.face is Face.TOP else EXACT.side_offset_m
        distance = outward @ (palm[:3, 3] - centre) - np.abs(along) @ box.extents / 2
        assert np.isclose(distance, offset)
        sideways = (np.eye(3) - np.outer(outward, outward)) @ (palm[:3, 3] - centre)
        height = palm[:3, 3] @ box.plane[:3] + box.plane[3]
        assert height >= EXACT.min_side_palm_height_m - 1e-9
        assert np.linalg.norm(sideways) < 1e-9 or np.isclose(height, EXACT.min_side_palm_height_m)


@given(boxes, seeds)
@hypothesis_settings(deadline=None, max_examples=50)
def test_thumb_up_on_the_sides_and_fingers_away_from_the_robot_on_top(
    box: SegmentedObject, seed: int
) -> None:
    for grasp in heuristic_grasps(box, SPACE, EXACT, CAMERA, np.random.default_rng(seed)):
        palm_in_world = CAMERA.T_world_camera @ SPACE.palm_pose(grasp.theta)
        if grasp.face is Face.TOP:
            np.testing.assert_allclose(palm_in_world[:3, 0], (0, 0, -1), atol=1e-6)
            assert palm_in_world[0, 2] >= -1e-6
        else:
            np.testing.assert_allclose(palm_in_world[:3, 1], (0, 0, 1), atol=1e-6)


@given(boxes)
@hypothesis_settings(deadline=None, max_examples=50)
def test_sides_are_the_two_that_look_at_the_camera(box: SegmentedObject) -> None:
    axes, centre = box.T_camera_box[:3, :2].T, box.T_camera_box[:3, 3]
    chosen = visible_sides(box)
    distances = []
    for normal in chosen:
        half = np.abs(axes @ normal) @ box.extents[:2] / 2
        near, far = (np.linalg.norm(centre + sign * half * normal) for sign in (1, -1))
        assert near <= far + 1e-9
        distances.append(near)
    assert distances[0] <= distances[1]
    assert abs(chosen[0] @ chosen[1]) < 1e-9


@given(boxes, seeds)
@hypothesis_settings(deadline=None, max_examples=50)
def test_preshapes_are_within_ranges_and_limits(box: SegmentedObject, seed: int) -> None:
    for grasp in heuristic_grasps(box, SPACE, EXACT, CAMERA, np.random.default_rng(seed)):
        assert (grasp.theta >= SPACE.lower).all()
        assert (grasp.theta <= SPACE.upper).all()
        for name, angle in zip(SPACE.joint_names, SPACE.joints(grasp.theta), strict=True):
            assert RANGES[name][0] <= angle <= RANGES[name][1]


@given(boxes, seeds)
@hypothesis_settings(deadline=None, max_examples=20)
def test_theta_and_palm_pose_are_inverse(box: SegmentedObject, seed: int) -> None:
    for grasp in heuristic_grasps(box, SPACE, EXACT, CAMERA, np.random.default_rng(seed)):
        again = SPACE.theta(SPACE.palm_pose(grasp.theta), SPACE.joints(grasp.theta))
        np.testing.assert_allclose(SPACE.palm_pose(again), SPACE.palm_pose(grasp.theta), atol=1e-9)


def test_low_objects_get_a_top_grasp_only() -> None:
    rng = np.random.default_rng(0)
    low = heuristic_grasps(standing_box((0.1, 0.05, 0.029), 0.3), SPACE, EXACT, CAMERA, rng)
    high = heuristic_grasps(standing_box((0.1, 0.05, 0.031), 0.3), SPACE, EXACT, CAMERA, rng)
    assert [grasp.face for grasp in low] == [Face.TOP]
    assert [grasp.face for grasp in high] == [Face.TOP, Face.SIDE_NEAREST, Face.SIDE_SECOND]


def test_noise_has_its_standard_deviation_and_both_axes_occur() -> None:
    noisy = HeuristicSettings(RANGES, offset_noise_m=0.001, axis_noise_rad=0.05)
    box, rng = standing_box((0.1, 0.05, 0.2), 0.3), np.random.default_rng(0)
    grasps = [heuristic_grasps(box, SPACE, noisy, CAMERA, rng) for _ in range(400)]
    heights = [SPACE.palm_pose(g[0].theta)[:3, 3] @ box.plane[:3] + box.plane[3] for g in grasps]
    assert abs(np.std(heights) - 0.001) < 0.0002
    assert abs(np.mean(heights) - 0.22) < 0.0003
    along_x = np.array([abs(SPACE.palm_pose(g[0].theta)[:3, 2] @ box.T_camera_box[:3, 0]) for g in grasps])
    assert 0.4 < np.mean(along_x > 0.5) < 0.6
    turns = np.arccos(along_x[along_x > 0.5])
    assert abs(np.sqrt(np.mean(turns**2)) - 0.05) < 0.01


def test_same_generator_state_gives_the_same_grasps() -> None:
    box = standing_box((0.1, 0.05, 0.2), 0.3)
    first, second, other = (
        heuristic_grasps(box, SPACE, HeuristicSettings(RANGES), CAMERA, np.random.default_rng(seed))
        for seed in (4, 4, 5)
    )
    for a, b, c in zip(first, second, other, strict=True):
        np.testing.assert_array_equal(a.theta, b.theta)
        assert not np.array_equal(a.theta, c.theta)


def test_a_joint_without_range_is_refused() -> None:
    ranges = {"finger_0": (0.0, 0.1), "finger_1": (0.0, 0.1)}
    with pytest.raises(InputError, match="thumb_0"):
        heuristic_grasps(
            standing_box((0.1, 0.05, 0.2), 0.3),
            SPACE,
            HeuristicSettings(ranges),
            CAMERA,
            np.random.default_rng(0),
        )
