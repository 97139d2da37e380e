"""Unfolding a package's surface onto a picture, as a carton is cut or a label is peeled off."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sim.objects.looks.artwork import Print
from sim.objects.looks.lettering import Box
from sim.objects.package_shapes import Size

SEEN_SHARE = 0.62
"""Of a label around half a bottle, what is seen from the front."""
MARGIN_M = 4e-4

Triangles = Float[np.ndarray, "n 3 3"]
Heights = tuple[float, float]
"""Lower and upper edge of a label (m)."""


@dataclass(frozen=True, eq=False)
class Unfolding:
    """Where each corner of a surface lies on a picture.

    Args:
        size: width and height of the picture (m).
        uvs: of the triangles' corners, 0-1, v pointing up.
        prints: what is printed where.
    """

    size: tuple[float, float]
    uvs: Float[np.ndarray, "n 3 2"]
    prints: Sequence[Print]


def peeled(triangles: Triangles, size: Size, label: Triangles, heights: Heights) -> Unfolding:
    """Halves of a round surface rolled out like the label; front and back are the same place."""
    ring = label[np.isclose(label[..., 2], label[..., 2].min())]
    centre = (ring[:, :2].min(axis=0) + ring[:, :2].max(axis=0)) / 2
    angles, lengths = _rolled_out(ring[:, :2] - centre)
    corners = triangles[..., :2] - centre
    front = corners[..., 0].mean(axis=1, keepdims=True) > 0
    turned = np.where(front[..., None], corners, -corners)
    along = np.interp(np.arctan2(turned[..., 1], turned[..., 0]), angles, lengths)
    width, height = float(lengths[-1]), size[2]
    area = (0.0, height - heights[1], width, height - heights[0])
    aside = (1 - SEEN_SHARE) / 2 * width
    middle = (aside, area[1], width - aside, area[3])
    uvs = np.stack((along / width, triangles[..., 2] / height), axis=-1)
    return Unfolding((width, height), uvs, [Print("front", area, middle)])


def carton(triangles: Triangles, size: Size) -> Unfolding:
    """A box: design on the broad sides, small print on the narrow ones, the brand on the lid."""
    x, y, z = size
    cells = [("front", (0, 0, y, z)), ("facts", (y, 0, y + x, z)), ("brand", (0, z, y, z + x))]
    return Unfolding(*_projected(triangles, size), [Print(kind, cell, cell) for kind, cell in cells])


def flat(triangles: Triangles, size: Size, label: Triangles, top: str, side: str) -> Unfolding:
    """What lies on its back: prints of these kinds on top and on the long sides, where the label is."""
    x, y, z = size
    low, high = label.min(axis=(0, 1)), label.max(axis=(0, 1))
    left, right = y / 2 + float(low[1]), y / 2 + float(high[1])
    above = (left, z + x / 2 + float(low[0]), right, z + x / 2 + float(high[0]))
    beside = (left, 0.0, right, z)
    return Unfolding(*_projected(triangles, size), [Print(side, beside, beside), Print(top, above, above)])


def panels(triangles: Triangles, size: Size, heights: Heights, repeats: int) -> Unfolding:
    """Printed on the broad sides, so many times side by side."""
    x, y, z = size
    top, bottom = z - heights[1], z - heights[0]
    narrow = (y, top, y + x, bottom)
    broad = [(y * k / repeats, top, y * (k + 1) / repeats, bottom) for k in range(repeats)]
    prints = [Print("front", cell, _inner(cell)) for cell in broad]
    return Unfolding(*_projected(triangles, size), [*prints, Print("paper", narrow, narrow)])


def _inner(cell: Box) -> Box:
    aside = 0.1 * (cell[2] - cell[0])
    return cell[0] + aside, cell[1], cell[2] - aside, cell[3]


def _rolled_out(ring: Float[np.ndarray, "n 2"]) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m"]]:
    """Angles (rad) of the ring's front half, and how far along it they are (m)."""
    angles, first = np.unique(np.round(np.arctan2(ring[:, 1], ring[:, 0]), 6), return_index=True)
    half = np.abs(angles) < np.pi / 2 + 1e-3
    points = ring[first[half]]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return angles[half], np.concatenate(((0.0,), np.cumsum(steps)))


def _projected(triangles: Triangles, size: Size) -> tuple[tuple[float, float], Float[np.ndarray, "n 3 2"]]:
    """Width and height (m) of a picture with a cell each for x, y and z, and the corners' places on it.

    Every triangle is seen along the axis that it faces most; opposite sides share a cell, so that text can
    be read on both.
    """
    x, y, z = size
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    facing = np.argmax(np.abs(normals), axis=1)
    forward = np.take_along_axis(normals, facing[:, None], axis=1) > 0
    sign = np.where(forward, 1.0, -1.0)
    px, py, down = triangles[..., 0], triangles[..., 1], z - triangles[..., 2]
    across = np.stack((sign * py + y / 2, -sign * px + x / 2, sign * py + y / 2), axis=-1)
    below = np.stack((down, down, px + x / 2), axis=-1)
    cell_sizes = np.array(((y, z), (x, z), (y, x)))
    corners = np.array(((0.0, 0.0), (y, 0.0), (0.0, z)))
    picked = np.stack(
        [np.take_along_axis(values, facing[:, None, None], axis=2)[..., 0] for values in (across, below)],
        axis=-1,
    )
    inside = np.clip(picked, MARGIN_M, cell_sizes[facing][:, None] - MARGIN_M) + corners[facing][:, None]
    width, height = x + y, x + z
    return (width, height), np.stack((inside[..., 0] / width, 1 - inside[..., 1] / height), axis=-1)
