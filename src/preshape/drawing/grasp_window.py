"""The part of a view in which the grasps are."""

import numpy as np
from jaxtyping import Float, UInt8

from preshape.geometry.camera import Camera

WIDTH_M = 0.5
"""Width of the window at the distance of the palms: room for the object and a hand on either side."""
MARGIN_PX = 80.0
"""Room around rectangles."""
ASPECT = 4 / 3
"""Width over height."""


def grasp_window(camera: Camera, theta: Float[np.ndarray, "s d"]) -> tuple[slice, slice]:
    """Rows and columns of the view around the palms of grasps (camera frame); never outside of the view."""
    palm = theta[:, :3].mean(axis=0)
    u, v = camera.project(palm)
    width = camera.fx * WIDTH_M / palm[2]
    return _interval(v, width / ASPECT, camera.height), _interval(u, width, camera.width)


def rectangle_window(camera: Camera, theta: Float[np.ndarray, "s 4"]) -> tuple[slice, slice]:
    """Rows and columns of the view around rectangles (u, v, angle, opening); never outside of the view."""
    centre = theta[:, :2].mean(axis=0)
    reach = float((np.abs(theta[:, :2] - centre).max(axis=1) + theta[:, 3]).max()) + MARGIN_PX
    u, v = centre
    return _interval(v, 2 * reach / ASPECT, camera.height), _interval(u, 2 * reach, camera.width)


def cut(
    picture: UInt8[np.ndarray, "h w 3"], window: tuple[slice, slice], scale: int
) -> UInt8[np.ndarray, "rows columns 3"]:
    """The window of a picture that is `scale` times as large as the view."""
    rows, columns = (slice(part.start * scale, part.stop * scale) for part in window)
    return picture[rows, columns]


def _interval(centre: float, length: float, limit: int) -> slice:
    """Interval of whole pixels, moved into 0 to `limit`, and cut where it is longer."""
    size = min(limit, max(1, round(length)))
    start = int(np.clip(round(centre - size / 2), 0, limit - size))
    return slice(start, start + size)
