"""Images as views for rectangles: whole, in theta's pixels, and if wanted with fewer of them."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor

from preshape.errors import InputError
from preshape.perception.image import CHANNEL_NAMES, eight_channel_image
from preshape.perception.observation import Observation
from preshape.perception.table import TableSettings, find_table
from preshape.perception.view_batch import ViewBatch

DEPTH = CHANNEL_NAMES.index("depth")
NORMALS = slice(DEPTH + 1, DEPTH + 4)
HEIGHT_LIMIT_M = 0.1
"""Heights beyond are cut off: floor and walls are no farther from a grasp than this says."""


@dataclass(frozen=True)
class RectangleViewSettings:
    """How an image becomes a view.

    Args:
        step_px: along each side, so many pixels of the image are averaged to one of the view; divides both.
        height: whether the channel of the depth holds heights over the table instead, which do not depend on
            where the camera stands; the paper has depth.
    """

    step_px: int = 1
    height: bool = False


def rectangle_image(
    observation: Observation, settings: RectangleViewSettings
) -> Float32[np.ndarray, "8 h w"]:
    """The 8-channel image of a view, unknown depth, normals and curvature 0 as in `eight_channel_image`.

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
    if settings.height:
        image[DEPTH] = height_over_table(observation)
    return _averaged(image, known, settings.step_px)


def rectangle_view(images: Float[Tensor, "b 8 h w"], step_px: int) -> ViewBatch:
    """Images of `rectangle_image` as the networks take them.

    A rectangle's point (u, v) in the image counts as the point (u, v, 1), which the intrinsics of the view
    take to the view's own pixels. Object points, table and box are left out: rectangles know of none.
    """
    count, scale = len(images), 1 / step_px
    # the centre of the image's first pixel is (0, 0), and so is that of the view's
    offset = (scale - 1) / 2
    return ViewBatch(
        images,
        torch.tensor([[scale, scale, offset, offset]]).expand(count, 4),
        torch.zeros(count, 0, 3),
        torch.zeros(count, 4),
        torch.eye(4).expand(count, 4, 4),
    )


def height_over_table(observation: Observation) -> Float32[np.ndarray, "h w"]:
    """Height (m) of each pixel's point over the table; 0 where it is unknown, or if no table is found."""
    points = observation.camera.unproject(observation.depth.astype(np.float64))
    up = observation.camera.T_world_camera[2, :3]
    try:
        height = find_table(points, up, TableSettings()).height(points)
    except InputError:
        return np.zeros(observation.depth.shape, dtype=np.float32)
    limited: Float32[np.ndarray, "h w"] = (
        np.nan_to_num(height).clip(-HEIGHT_LIMIT_M, HEIGHT_LIMIT_M).astype(np.float32)
    )
    return limited


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
