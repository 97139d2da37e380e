"""Poses against their inverses, and the Euler angles of theta against SciPy's."""

import numpy as np
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from preshape.geometry.pose import (
    euler_xyz_from_rotation,
    invert_pose,
    make_pose,
    pose_from_quaternion,
    quaternion_from_pose,
    rotation_from_euler_xyz,
    transform_points,
)

coordinates = st.floats(-3, 3, width=32)
angles = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))


def pose_of(euler: tuple[float, float, float], position: np.ndarray) -> np.ndarray:
    return make_pose(Rotation.from_euler("xyz", euler).as_matrix(), position)


poses = st.builds(pose_of, angles, arrays(np.float64, 3, elements=coordinates))


@given(poses, arrays(np.float64, (5, 3), elements=coordinates))
def test_a_pose_and_its_inverse_bring_points_back(pose: np.ndarray, points: np.ndarray) -> None:
    there = transform_points(pose, points)
    np.testing.assert_allclose(transform_points(invert_pose(pose), there), points, atol=1e-12)
    np.testing.assert_allclose(pose @ invert_pose(pose), np.eye(4), atol=1e-12)


@given(poses, poses, arrays(np.float64, (4, 3), elements=coordinates))
def test_names_cancel_in_products(T_a_b: np.ndarray, T_b_c: np.ndarray, points_c: np.ndarray) -> None:
    one_by_one = transform_points(T_a_b, transform_points(T_b_c, points_c))
    np.testing.assert_allclose(transform_points(T_a_b @ T_b_c, points_c), one_by_one, atol=1e-12)


@given(poses)
def test_quaternions_come_back_as_wxyz_with_positive_w(pose: np.ndarray) -> None:
    wxyz = quaternion_from_pose(pose)
    assert wxyz[0] >= 0
    np.testing.assert_allclose(pose_from_quaternion(pose[:3, 3], wxyz), pose, atol=1e-12)


def test_a_quarter_turn_about_z_has_its_w_first() -> None:
    turn = make_pose(Rotation.from_euler("z", np.pi / 2).as_matrix(), np.zeros(3))
    np.testing.assert_allclose(quaternion_from_pose(turn), [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


@given(angles)
def test_euler_angles_are_extrinsic_xyz_both_ways(euler: tuple[float, float, float]) -> None:
    rotation = rotation_from_euler_xyz(torch.tensor(euler, dtype=torch.float64)).numpy()
    roll, pitch, yaw = (Rotation.from_euler(axis, angle) for axis, angle in zip("xyz", euler, strict=True))
    np.testing.assert_allclose(rotation, (yaw * pitch * roll).as_matrix(), atol=1e-12)
    np.testing.assert_allclose(euler_xyz_from_rotation(rotation), euler, atol=1e-9)


def test_rotation_from_euler_angles_has_the_right_gradient() -> None:
    euler = torch.tensor([[0.3, -0.7, 2.0], [-1.0, 0.2, 0.1]], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(rotation_from_euler_xyz, (euler,))
