"""Segmentation finds the object, its height and its box; never the robot, the floor or a shadow of noise."""

from typing import Any

import numpy as np
import pytest

from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, SegmentedObject, segment
from preshape.perception.table import find_table

SETTINGS = SegmentationSettings()


def iou(segmented: SegmentedObject, observation: Observation) -> float:
    """Intersection over union with the true mask, on pixels of known depth."""
    truth = observation.mask & np.isfinite(observation.depth)
    return (segmented.mask & truth).sum() / (segmented.mask | truth).sum()


def box_in_world(segmented: SegmentedObject, camera: Camera) -> np.ndarray:
    return camera.T_world_camera @ segmented.T_camera_box


@pytest.mark.parametrize("noise_seed", [None, 3])
@pytest.mark.parametrize(
    ("size", "yaw"), [((0.10, 0.06, 0.20), 0.4), ((0.16, 0.05, 0.09), 2.2), ((0.12, 0.08, 0.03), 1.1)]
)
def test_box_is_found_with_its_pose(
    table_top: Any, size: tuple[float, float, float], yaw: float, noise_seed: int | None
) -> None:
    observation = table_top.view(table_top.box(size, (0.86, -0.07), yaw), noise_seed=noise_seed)
    segmented = segment(observation, SETTINGS)
    world_box = box_in_world(segmented, observation.camera)
    assert iou(segmented, observation) > 0.85
    np.testing.assert_allclose(world_box[:3, 3], (0.86, -0.07, table_top.height_m + size[2] / 2), atol=0.008)
    np.testing.assert_allclose(segmented.extents, size, atol=0.01)
    turned = abs(world_box[:2, 0] @ (np.cos(yaw), np.sin(yaw)))
    assert np.degrees(np.arccos(min(1.0, turned))) < 3.0


def test_box_frame_is_right_handed_and_upright(table_top: Any) -> None:
    segmented = segment(table_top.view(table_top.box((0.1, 0.06, 0.2), yaw=0.4), noise_seed=0), SETTINGS)
    rotation = segmented.T_camera_box[:3, :3]
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-9)
    assert np.linalg.det(rotation) > 0
    np.testing.assert_allclose(rotation[:, 2], segmented.plane[:3])
    assert segmented.extents[0] >= segmented.extents[1] - 0.005
    bottom = segmented.T_camera_box[:3, 3] - rotation[:, 2] * segmented.extents[2] / 2
    assert abs(bottom @ segmented.plane[:3] + segmented.plane[3]) < 1e-9


@pytest.mark.parametrize("size", [(0.12, 0.09, 0.015), (0.19, 0.03, 0.02), (0.03, 0.03, 0.12)])
def test_flat_and_thin_objects_are_found(table_top: Any, size: tuple[float, float, float]) -> None:
    observation = table_top.view(table_top.box(size, (0.72, 0.08), 0.9), noise_seed=1)
    segmented = segment(observation, SETTINGS)
    assert iou(segmented, observation) > 0.7
    assert abs(segmented.extents[2] - size[2]) < 0.006


def test_cylinder(table_top: Any) -> None:
    observation = table_top.view(table_top.cylinder(0.035, 0.2), noise_seed=2)
    segmented = segment(observation, SETTINGS)
    assert iou(segmented, observation) > 0.85
    np.testing.assert_allclose(segmented.extents, (0.07, 0.07, 0.2), atol=0.015)


def test_robot_arm_is_not_the_object(table_top: Any) -> None:
    arm = [
        table_top.slab((-0.1, -0.1, 0.0), (0.1, 0.1, 1.2)),
        table_top.slab((0.1, -0.06, 0.95), (0.66, 0.06, 1.05)),  # reaches over the table
        table_top.slab((0.58, -0.06, 0.68), (0.64, 0.06, 0.95)),  # hangs down over the table
    ]
    observation = table_top.view(
        table_top.box((0.08, 0.05, 0.06), (0.88, 0.02)), surroundings=arm, noise_seed=5
    )
    assert iou(segment(observation, SETTINGS), observation) > 0.8


def test_vertical_wall_is_not_the_table(table_top: Any) -> None:
    wall = table_top.slab((0.2, 0.3, 0.0), (1.4, 0.32, 1.6))  # the largest plane in the centre of the view
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)), surroundings=[wall], noise_seed=5)
    assert iou(segment(observation, SETTINGS), observation) > 0.8


def test_plane_is_the_table(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)), noise_seed=7)
    points = observation.camera.unproject(observation.depth.astype(np.float64))
    world_up = observation.camera.T_world_camera[2, :3]
    table = find_table(points, world_up, SETTINGS.table)
    assert np.degrees(np.arccos(table.plane[:3] @ world_up)) < 0.2
    assert abs(table.plane[3] - (1.25 - table_top.height_m)) < 0.002
    corners = np.array([[x, y, table_top.height_m] for x in (0.51, 1.09) for y in (-0.44, 0.44)])
    rotation, eye = observation.camera.T_world_camera[:3, :3], observation.camera.T_world_camera[:3, 3]
    assert table.covers((corners - eye) @ rotation, 0.02).all()
    assert not table.covers((corners + np.array([0.0, 1.5, 0.0]) - eye) @ rotation, 0.02).any()


@pytest.mark.parametrize("noise_seed", range(3))
def test_empty_table_has_no_object(table_top: Any, noise_seed: int) -> None:
    with pytest.raises(InputError, match="No object"):
        segment(table_top.view(noise_seed=noise_seed), SETTINGS)


def test_hovering_object_is_no_object(table_top: Any) -> None:
    with pytest.raises(InputError, match="No object"):
        segment(table_top.view(table_top.box((0.08, 0.08, 0.08), floating=0.1), noise_seed=0), SETTINGS)


def test_blind_sensor_and_wrong_camera_pose_have_no_table(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)))
    blind = Observation(observation.rgb, np.full_like(observation.depth, np.nan), None, observation.camera)
    with pytest.raises(InputError, match="No table"):
        segment(blind, SETTINGS)
    camera = observation.camera
    level = Camera(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, np.eye(4))
    with pytest.raises(InputError, match="No table"):
        segment(Observation(observation.rgb, observation.depth, None, level), SETTINGS)


def test_same_view_gives_the_same_object(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2), yaw=0.3), noise_seed=9)
    first, second = segment(observation, SETTINGS), segment(observation, SETTINGS)
    np.testing.assert_array_equal(first.T_camera_box, second.T_camera_box)
    np.testing.assert_array_equal(first.mask, second.mask)
