"""Projection against its inverse, and where the camera looks."""

import numpy as np
import torch
from hypothesis import given
from hypothesis import strategies as st

from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, transform_points

CAMERA = Camera.looking_at(
    np.array([0.8, -0.9, 1.25]), np.array([0.8, 0.0, 0.65]), width=64, height=48, focal=52.0
)


@given(st.integers(0, 63), st.integers(0, 47), st.floats(0.2, 5.0))
def test_projection_undoes_unprojection(u: int, v: int, distance: float) -> None:
    depth = np.full((48, 64), np.nan)
    depth[v, u] = distance
    points = CAMERA.unproject(depth)
    assert np.isnan(points).any(axis=-1).sum() == depth.size - 1
    np.testing.assert_allclose(CAMERA.project(points[v, u]), (u, v), atol=1e-9)
    assert points[v, u, 2] == distance


def test_the_target_is_in_the_middle_and_up_is_up() -> None:
    T_camera_world = invert_pose(CAMERA.T_world_camera)
    target, above, beside = transform_points(
        T_camera_world, np.array([[0.8, 0, 0.65], [0.8, 0, 0.75], [0.9, 0, 0.65]])
    )
    np.testing.assert_allclose(CAMERA.project(target), (31.5, 23.5), atol=1e-9)
    assert CAMERA.project(above)[1] < 23.5
    assert CAMERA.project(beside)[0] > 31.5
    rotation = CAMERA.T_world_camera[:3, :3]
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
    assert np.isclose(np.linalg.det(rotation), 1)


def test_tensors_and_arrays_project_alike() -> None:
    points = np.array([[0.1, -0.2, 1.0], [0.0, 0.3, 2.0]])
    for array, tensor in zip(CAMERA.project(points), CAMERA.project(torch.from_numpy(points)), strict=True):
        np.testing.assert_array_equal(array, tensor.numpy())
