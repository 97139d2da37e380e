"""Which way up a scanned object stands."""

import numpy as np
import trimesh
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from preshape.geometry.pose import make_pose
from sim.objects.object_model import ObjectModel

AS_MODELLED_RAD = np.deg2rad(15.0)
"""A stable pose within this angle of the modelled one is what the modeller meant."""


def stood_up(model: ObjectModel) -> ObjectModel:
    """The model turned, about its centre of mass, onto a face of its hull on which it stays.

    If it is stable about as it was modelled, with z up, then so; else as it would most probably land when
    thrown (Goldberg et al. 1999). It keeps its yaw as far as that can be.
    """
    hull = trimesh.Trimesh(np.concatenate(model.collision_parts)).convex_hull
    poses, probabilities = hull.compute_stable_poses(center_mass=np.zeros(3), sigma=0.0, n_samples=1)
    if not len(poses):
        return model
    # Row 2 of a rotation is the direction, in the model's frame, that it turns upwards.
    upward = poses[:, 2, :3] / np.linalg.norm(poses[:, 2, :3], axis=1, keepdims=True)
    tilt = np.arccos(np.clip(upward[:, 2], -1, 1))
    near = tilt < AS_MODELLED_RAD
    chosen = np.argmax(np.where(near, probabilities, -1) if near.any() else probabilities)
    return model.moved(make_pose(_rotation_to_z(upward[chosen]), np.zeros(3)))


def _rotation_to_z(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """The smallest rotation that turns a unit vector to +z."""
    axis = np.cross(direction, [0.0, 0.0, 1.0])
    length = np.linalg.norm(axis)
    if length < 1e-9:
        return np.diag([1.0, np.sign(direction[2]), np.sign(direction[2])])
    angle = np.arctan2(length, direction[2])
    return Rotation.from_rotvec(axis / length * angle).as_matrix()
