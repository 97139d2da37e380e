"""Hollow round packages: cups, plates, sleeves."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from sim.objects.loft import COLLISION_CORNERS, VISUAL_CORNERS, strip
from sim.objects.package_shapes import Size, Solid

SECTORS = 8
"""The wall collides as this many convex pieces, which make the hole an octagon."""

Outline = tuple[tuple[float, float], ...]
"""Radius and height (m) along a cross-section, from the bottom outwards, up, and inwards."""


@dataclass(frozen=True)
class Vessel:
    """An open cone with a wall and, unless it is a sleeve, a floor.

    Args:
        foot: diameter at the bottom over that of the brim.
        wall: thickness, horizontally, over the diameter of the brim.
        floor: thickness over the height; 0 for none.
    """

    foot: float
    wall: float
    floor: float

    def solid(self, size: Size) -> Solid:
        """The solid that fills a box of the size, resting on z = 0."""
        brim, height = size[0] / 2, size[2]
        wall, floor, foot = self.wall * size[0], self.floor * height, self.foot * brim
        inner_foot = foot + (brim - foot) * self.floor - wall
        outside: Outline = ((foot, 0.0), (brim, height))
        inside: Outline = ((brim, height), (brim - wall, height), (inner_foot, floor))
        parts = _sectors((*outside, *inside[1:], (inner_foot, 0.0)))
        if self.floor:
            disc = _rings(((inner_foot, 0.0), (inner_foot, floor)), COLLISION_CORNERS)
            parts.append(np.concatenate(disc))
            outside, inside = ((0.0, 0.0), *outside), (*inside, (0.0, floor))
        else:
            inside = (*inside, (foot, 0.0))
        return Solid(tuple(parts), {"body": _turned(outside), "label": _turned(inside)})


def _sectors(outline: Outline) -> list[Float[np.ndarray, "_ 3"]]:
    rings = np.stack(_rings(outline, COLLISION_CORNERS))
    steps = COLLISION_CORNERS // SECTORS
    pieces = []
    for start in range(0, COLLISION_CORNERS, steps):
        corners = rings[:, np.arange(start, start + steps + 1) % COLLISION_CORNERS].reshape(-1, 3)
        pieces.append(corners[np.sort(ConvexHull(corners).vertices)])
    return pieces


def _turned(outline: Outline) -> Float[np.ndarray, "_ 3 3"]:
    """Triangles of the surface that the outline sweeps around z."""
    rings = _rings(outline, VISUAL_CORNERS)
    return np.concatenate([strip(lower, upper) for lower, upper in pairwise(rings)])


def _rings(outline: Outline, corners: int) -> list[Float[np.ndarray, "corners 3"]]:
    angles = np.arange(corners) * 2 * np.pi / corners
    x, y = np.cos(angles), np.sin(angles)
    return [np.stack((radius * x, radius * y, np.full(corners, z)), axis=1) for radius, z in outline]
