"""From rectangles to gripper poses: the inverse gives the rectangle back, fingers stay off the table."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_metric import angle_between
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import is_pose
from preshape.grasps.rectangle_pose import RectanglePoseSettings, jaw_pose, rectangle_of
from preshape.perception.observation import Observation

SETTINGS = RectanglePoseSettings()
TABLE_M = 0.59
CAMERA = Camera.looking_at(
    np.array([0.42, 0.0, 1.59]), np.array([0.6, 0.0, TABLE_M]), width=640, height=480, focal=525.0
)
UP = CAMERA.T_world_camera[2, :3]
TABLE = np.append(UP, CAMERA.T_world_camera[2, 3] - TABLE_M)
RECTANGLES = st.builds(
    GraspRectangle,
    st.floats(120, 520),
    st.floats(100, 380),
    st.floats(0, np.pi),
    st.floats(10, 90),
    st.just(25.0),
)


def view_of(normal: np.ndarray, point: np.ndarray) -> Observation:
    """A plane through a point (m, camera frame) that fills the image."""
    x, y = CAMERA.rays()
    depth = (normal @ point) / (normal[0] * x + normal[1] * y + normal[2])
    return Observation(np.zeros((480, 640, 3), np.uint8), depth.astype(np.float32), None, CAMERA)


def surface(height_m: float, tilt_rad: float = 0.0, turn_rad: float = 0.0) -> Observation:
    """A plane over the middle of the table, tilted towards some side."""
    tilt = Rotation.from_rotvec(tilt_rad * np.array([np.cos(turn_rad), np.sin(turn_rad), 0.0])).as_matrix()
    normal = CAMERA.T_world_camera[:3, :3].T @ tilt @ np.array([0.0, 0.0, 1.0])
    forward = CAMERA.T_world_camera[2, 3] - TABLE_M - height_m
    return view_of(normal, np.array([0.0, 0.0, forward / -UP[2]]))


@settings(max_examples=25, deadline=None)
@given(RECTANGLES, st.floats(0, 0.2), st.floats(0, 0.9), st.floats(0, 2 * np.pi))
def test_the_pose_gives_its_rectangle_back_and_keeps_off_the_table(
    rectangle: GraspRectangle, height_m: float, tilt_rad: float, turn_rad: float
) -> None:
    pose = jaw_pose(rectangle, surface(height_m, tilt_rad, turn_rad), TABLE, SETTINGS)
    assert is_pose(pose.T_camera_jaws)
    back = rectangle_of(pose, CAMERA, 25.0)
    np.testing.assert_allclose((back.u, back.v), (rectangle.u, rectangle.v), atol=1e-6)
    assert back.opening_px == pytest.approx(rectangle.opening_px, abs=1e-6)
    assert angle_between(back, rectangle) < 1e-8
    approach, along, across = pose.T_camera_jaws[:3, :3].T
    assert -approach @ UP >= np.cos(SETTINGS.max_tilt_rad) - 1e-9
    reach = pose.opening_m / 2 + SETTINGS.finger_m
    corners = [
        pose.T_camera_jaws[:3, 3] + a * reach * along + b * SETTINGS.jaw_m / 2 * across
        for a in (-1, 1)
        for b in (-1, 1)
    ]
    assert min(np.array(corners) @ UP + TABLE[3]) >= SETTINGS.table_clearance_m - 1e-9
    assert pose.advance_m <= SETTINGS.insertion_m


@pytest.mark.parametrize(("tilt_rad", "kept"), [(0.0, True), (0.4, True), (0.7, False), (1.1, False)])
def test_the_gripper_comes_against_the_normal_within_its_cone(tilt_rad: float, kept: bool) -> None:
    pose = jaw_pose(
        GraspRectangle(320.0, 240.0, 0.5, 40.0, 25.0), surface(0.1, tilt_rad, 0.3), TABLE, SETTINGS
    )
    tilt = np.arccos(-pose.T_camera_jaws[:3, 0] @ UP)
    assert tilt == pytest.approx(tilt_rad if kept else SETTINGS.max_tilt_rad, abs=1e-3)


def test_pixels_become_metres_at_the_depth_of_the_surface() -> None:
    straight = view_of(np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 0.8]))
    upright = np.array([0.0, 0.0, -1.0, 1.0])
    pose = jaw_pose(GraspRectangle(319.5, 239.5, 0.0, 52.5, 25.0), straight, upright, SETTINGS)
    assert pose.opening_m == pytest.approx(52.5 * 0.8 / 525)
    np.testing.assert_allclose(pose.T_camera_jaws[:3, 1], [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(pose.T_camera_jaws[:3, 3], [0, 0, 0.83], atol=1e-6)


def test_holes_in_the_depth_are_bridged() -> None:
    whole = surface(0.1)
    rectangle = GraspRectangle(320.0, 240.0, 0.5, 40.0, 25.0)
    expected = jaw_pose(rectangle, whole, TABLE, SETTINGS)
    for half_width, turned in ((3, False), (12, True)):
        depth = whole.depth.copy()
        depth[240 - half_width : 241 + half_width, 320 - half_width : 321 + half_width] = np.nan
        view = Observation(whole.rgb, depth, None, CAMERA)
        pose = jaw_pose(rectangle, view, TABLE, SETTINGS)
        np.testing.assert_allclose(pose.T_camera_jaws, expected.T_camera_jaws, atol=5e-3)
        if turned:  # too few neighbours for a normal: straight down
            np.testing.assert_allclose(pose.T_camera_jaws[:3, 0], -UP, atol=1e-9)
    with pytest.raises(InputError, match="no depth"):
        jaw_pose(
            rectangle, Observation(whole.rgb, np.full_like(depth, np.nan), None, CAMERA), TABLE, SETTINGS
        )
