"""Images as views for rectangles: whole, in theta's pixels, and if wanted with fewer of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32

from preshape.errors import InputError
from preshape.perception.image import DEPTH, NORMALS, eight_channel_image
from preshape.perception.observation import Observation
from preshape.perception.table import TableSettings, find_table
from preshape.perception.view_batch import ViewBatch


@dataclass(frozen=True)
class RectangleViewSettings:
    """How an image becomes a view.

    Args:
        step_px: along each side, so many pixels of the image are averaged to one of the view; divides both.
    """

    step_px: int = 1


class RectangleView(NamedTuple):
    """An image as the networks see it.

    Args:
        image: the 8 channels of `eight_channel_image`; half precision is enough.
        intrinsics: fx, fy, cx, cy of the camera in pixels of this image.
        table: the table's plane in the camera frame: unit normal up, n . p + d is the height of p in m.
    """

    image: Float[np.ndarray, "8 h w"]
    intrinsics: Float32[np.ndarray, "4"]
    table: Float32[np.ndarray, "4"]


def rectangle_view(observation: Observation, settings: RectangleViewSettings) -> RectangleView:
    """The view of an image, unknown depth, normals and curvature 0 as in `eight_channel_image`.

    Averages are over the pixels where a channel is known.

    Raises:
        InputError: if the image cannot be divided into such steps.
    """
    height, width = observation.depth.shape
    if height % settings.step_px or width % settings.step_px:
        raise InputError(
            f"An image of {width} x {height} pixels cannot be averaged over {settings.step_px}",
            where="step_px",
            fix="choose a step that divides both, such as 1, 2 or 4",
        )
    image = eight_channel_image(observation)
    known = np.ones(image.shape, dtype=bool)
    known[DEPTH] = np.isfinite(observation.depth)
    known[DEPTH + 1 :] = image[NORMALS].any(axis=0)
    camera, step = observation.camera, settings.step_px
    # the centre of the image's first pixel is (0, 0), and so is that of the view's
    centre = ((own - (step - 1) / 2) / step for own in (camera.cx, camera.cy))
    intrinsics = np.array([camera.fx / step, camera.fy / step, *centre], dtype=np.float32)
    return RectangleView(_averaged(image, known, step), intrinsics, _table(observation))


def rectangle_batch(views: Sequence[RectangleView]) -> ViewBatch:
    """Views of images as the networks take them, in single precision.

    Object points and box are left out: rectangles know of none.
    """
    images, intrinsics, tables = (
        torch.from_numpy(np.stack(part)).float() for part in zip(*views, strict=True)
    )
    count = len(views)
    return ViewBatch(images, intrinsics, torch.zeros(count, 0, 3), tables, torch.eye(4).expand(count, 4, 4))


def _table(observation: Observation) -> Float32[np.ndarray, "4"]:
    """The table's plane; across the line of sight at the median depth if no table is found."""
    points = observation.camera.unproject(observation.depth.astype(np.float64))
    try:
        plane = find_table(points, observation.camera.T_world_camera[2, :3], TableSettings()).plane
    except InputError:
        known = observation.depth[np.isfinite(observation.depth)]
        plane = np.array([0.0, 0.0, -1.0, float(np.median(known)) if len(known) else 1.0])
    return plane.astype(np.float32)


def _averaged(
    image: Float32[np.ndarray, "8 h w"], known: Bool[np.ndarray, "8 h w"], step: int
) -> Float32[np.ndarray, "8 hs ws"]:
    """Means over squares of known pixels; 0 where none is known."""
    channels, height, width = image.shape
    squares = (channels, height // step, step, width // step, step)
    total = np.where(known, image, 0).reshape(squares).sum(axis=(2, 4))
    count = known.reshape(squares).sum(axis=(2, 4))
    mean: Float32[np.ndarray, "8 hs ws"] = (total / np.maximum(count, 1)).astype(np.float32)
    return mean
