"""Depth images as another camera would have seen them."""

import numpy as np
import open3d as o3d
from jaxtyping import Float, Float32, Integer

from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, transform_points

DEPTH_STEP_M = 0.02
"""Neighbouring pixels whose depths differ by more belong to different surfaces."""


def registered_depth(
    depth: Float[np.ndarray, "h w"], sensor: Camera, camera: Camera
) -> Float32[np.ndarray, "h2 w2"]:
    """Depth (m) at the pixels of `camera` from a depth image of `sensor`.

    The sensor's points are joined to a surface, pixel by pixel but not across steps in depth, and a ray of
    each pixel is cast at it: the first hit counts, as in a z-buffer. Unlike points that are projected one by
    one this leaves no gaps where the camera has more pixels than the sensor, and each depth is that of the
    pixel's centre.

    Args:
        depth: depth image of the sensor (m); NaN where it saw nothing.
        sensor: the camera that took it.
        camera: the camera that shall see it. Only the pose of the two towards each other matters.

    Returns:
        Distance along the camera's optical axis; NaN where the sensor saw nothing.
    """
    triangles = _surface(depth)
    if not len(triangles):
        return np.full((camera.height, camera.width), np.nan, dtype=np.float32)
    T_camera_sensor = invert_pose(camera.T_world_camera) @ sensor.T_world_camera
    points = transform_points(T_camera_sensor, sensor.unproject(depth.astype(np.float64)).reshape(-1, 3))
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor.from_numpy(np.nan_to_num(points).astype(np.float32)),
        o3d.core.Tensor.from_numpy(triangles.astype(np.uint32)),
    )
    x, y = camera.rays(np.float32)
    rays = np.zeros((camera.height, camera.width, 6), dtype=np.float32)
    # Of length 1 along the optical axis, so that the distance along a ray is the depth.
    rays[..., 3], rays[..., 4], rays[..., 5] = x, y, 1.0
    hits = scene.cast_rays(o3d.core.Tensor.from_numpy(rays))["t_hit"].numpy()
    return np.where(np.isfinite(hits), hits, np.float32(np.nan))


def _surface(depth: Float[np.ndarray, "h w"]) -> Integer[np.ndarray, "t 3"]:
    """Triangles between neighbouring pixels on one surface, as numbers of pixels."""
    number = np.arange(depth.size).reshape(depth.shape)
    corners = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    here, right, below, across = (corner.ravel() for corner in corners)
    triangles = np.concatenate(
        (np.stack((here, below, right), axis=1), np.stack((right, below, across), axis=1))
    )
    depths = depth.ravel()[triangles]
    # Comparisons with NaN are false, so unknown pixels drop out here.
    return np.asarray(triangles[depths.max(axis=1) - depths.min(axis=1) < DEPTH_STEP_M])
