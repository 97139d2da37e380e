"""Pinhole camera: intrinsics and its pose in the world."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from preshape.geometry.pose import make_pose


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera without distortion.

    The optical frame has x to the right, y down and z forward. Pixel (u, v) has its centre at whole numbers.

    Args:
        width, height: image size in pixels.
        fx, fy, cx, cy: intrinsics in pixels.
        T_world_camera: pose of the optical frame in the world.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    T_world_camera: Float[np.ndarray, "4 4"]

    def project(self, points: Any) -> tuple[Any, Any]:
        """Pixel coordinates (u, v) of points (..., 3) in the camera frame; NumPy arrays or tensors."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        return self.fx * x / z + self.cx, self.fy * y / z + self.cy

    def rays(self, dtype: Any = np.float64) -> tuple[Float[np.ndarray, "1 w"], Float[np.ndarray, "h 1"]]:
        """x of each column and y of each row of the image at depth 1 (m)."""
        x = (np.arange(self.width) - self.cx) / self.fx
        y = (np.arange(self.height) - self.cy) / self.fy
        return x.astype(dtype)[None, :], y.astype(dtype)[:, None]

    def unproject(self, depth: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w 3"]:
        """Organised points in the camera frame (m) of a depth image (m, along z); NaN stays NaN."""
        x, y = self.rays(depth.dtype)
        points = np.empty((*depth.shape, 3), dtype=depth.dtype)
        points[..., 0], points[..., 1], points[..., 2] = x * depth, y * depth, depth
        return points

    @classmethod
    def looking_at(
        cls,
        eye: Float[np.ndarray, "3"],
        target: Float[np.ndarray, "3"],
        *,
        width: int,
        height: int,
        focal: float,
    ) -> "Camera":
        """Camera at `eye` (m, world) that looks at `target`, with the world's z pointing up in the image."""
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        rotation = np.stack((right, np.cross(forward, right), forward), axis=1)
        centre = ((width - 1) / 2, (height - 1) / 2)
        return cls(width, height, focal, focal, *centre, make_pose(rotation, eye))
