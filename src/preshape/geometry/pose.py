"""Rigid poses as 4x4 homogeneous matrices.

`T_a_b` is the pose of frame b in frame a: `p_a = T_a_b @ p_b`. Quaternions are wxyz. Euler angles are
extrinsic (static) XYZ, R = Rz(yaw) Ry(pitch) Rx(roll), and exist only inside theta.
"""

import numpy as np
import torch
from jaxtyping import Float
from scipy.spatial.transform import Rotation
from torch import Tensor


def make_pose(
    rotation: Float[np.ndarray, "3 3"], translation: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "4 4"]:
    """Pose with the given rotation and translation (m)."""
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = translation
    return pose


def is_pose(matrix: Float[np.ndarray, "4 4"]) -> bool:
    """Whether a matrix is a pose: a rotation, to a thousandth, with a translation."""
    rotation = matrix[:3, :3]
    return bool(
        np.isfinite(matrix).all()
        and np.abs(rotation).max() <= 1.01
        and np.allclose(rotation.T @ rotation, np.eye(3), atol=1e-3)
        and np.linalg.det(rotation) > 0
        and np.allclose(matrix[3], [0.0, 0.0, 0.0, 1.0], rtol=0, atol=1e-9)
    )


def invert_pose(pose: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, "4 4"]:
    """T_b_a from T_a_b."""
    rotation_inverse = pose[:3, :3].T
    return make_pose(rotation_inverse, -rotation_inverse @ pose[:3, 3])


def transform_points(
    pose: Float[np.ndarray, "4 4"], points: Float[np.ndarray, "*n 3"]
) -> Float[np.ndarray, "*n 3"]:
    """Points given in b, expressed in a, for pose T_a_b."""
    moved: Float[np.ndarray, "*n 3"] = points @ pose[:3, :3].T + pose[:3, 3]
    return moved


def pose_over_plane(plane: Float[np.ndarray, "4"]) -> Float[np.ndarray, "4 4"]:
    """T_plane_camera for a plane (a, b, c, d) in the camera frame, with n . p + d the height of p over it.

    The plane's frame has z along its normal, its origin under the camera, and x along the image's right.
    """
    x = np.array([1.0, 0.0, 0.0]) - plane[0] * plane[:3]
    x /= np.linalg.norm(x)
    axes = np.stack((x, np.cross(plane[:3], x), plane[:3]))
    return make_pose(axes, np.array([0.0, 0.0, plane[3]]))


def pose_from_quaternion(
    position: Float[np.ndarray, "3"], wxyz: Float[np.ndarray, "4"]
) -> Float[np.ndarray, "4 4"]:
    """Pose from a position (m) and a wxyz quaternion of any positive length."""
    return make_pose(Rotation.from_quat(wxyz, scalar_first=True).as_matrix(), position)


def quaternion_from_pose(pose: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, "4"]:
    """Unit wxyz quaternion of a pose, with w >= 0."""
    wxyz: Float[np.ndarray, "4"] = Rotation.from_matrix(pose[:3, :3]).as_quat(
        canonical=True, scalar_first=True
    )
    return wxyz


def euler_xyz_from_rotation(rotation: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3"]:
    """Extrinsic XYZ Euler angles (rad); pitch lies within +-pi/2, where it is singular."""
    angles: Float[np.ndarray, "3"] = Rotation.from_matrix(rotation).as_euler("xyz")
    return angles


def rotation_from_euler_xyz(angles: Float[Tensor, "*b 3"]) -> Float[Tensor, "*b 3 3"]:
    """Rotation matrices of extrinsic XYZ Euler angles (rad), differentiable."""
    (cr, cp, cy), (sr, sp, sy) = angles.cos().unbind(-1), angles.sin().unbind(-1)
    rows = (
        torch.stack((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr), dim=-1),
        torch.stack((sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr), dim=-1),
        torch.stack((-sp, cp * sr, cp * cr), dim=-1),
    )
    return torch.stack(rows, dim=-2)
