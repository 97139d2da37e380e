"""Lofts: solids between cross-sections stacked along z, the way that most packages are shaped."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

COLLISION_CORNERS = 24
"""Corners of a round cross-section that collides: a 24-gon lies within 1 % of its circle's radius."""
VISUAL_CORNERS = 48
CONVEXITY_TOLERANCE = 0.01
"""Slices are joined to one convex part while their common hull adds at most this share of volume."""


@dataclass(frozen=True)
class Station:
    """A cross-section at height z.

    Args:
        z: height (m).
        width, depth: full size along x and y (m).
        roundness: exponent n of the superellipse |2x/width|^n + |2y/depth|^n = 1: 2 is an ellipse, 4 a
            rounded rectangle, infinity a rectangle.
        material: of the wall from here to the next station, and of the lid of the last.
        offset_y: centre of the cross-section along y (m).
    """

    z: float
    width: float
    depth: float
    roundness: float
    material: str
    offset_y: float = 0.0

    def ring(self, angles: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 3"]:
        """Points (m) of the outline in the given directions (rad) from its centre, in units of its size."""
        x, y = np.cos(angles), np.sin(angles)
        if math.isinf(self.roundness):
            reach = np.maximum(np.abs(x), np.abs(y))
        else:
            reach = (np.abs(x) ** self.roundness + np.abs(y) ** self.roundness) ** (1 / self.roundness)
        return np.stack(
            (x / reach * self.width / 2, y / reach * self.depth / 2 + self.offset_y, np.full_like(x, self.z)),
            axis=1,
        )


Loft = Sequence[Station]
"""Stations from the bottom to the top; two at the same height make a step."""


def convex_parts(loft: Loft, *, lying: bool = False) -> list[Float[np.ndarray, "_ 3"]]:
    """Vertices of as few convex parts as fill the loft; `lying` turns round ones onto a flat side."""
    rings = [_outline(station, lying) for station in loft]
    slices = [(a, b) for a, b in pairwise(rings) if b[0, 2] > a[0, 2]]
    parts: list[list[Float[np.ndarray, "_ 3"]]] = []
    filled = 0.0
    for bottom, top in slices:
        volume = ConvexHull(np.concatenate((bottom, top))).volume
        if parts:
            joined = ConvexHull(np.concatenate((*parts[-1], bottom, top))).volume
            if joined <= (1 + CONVEXITY_TOLERANCE) * (filled + volume):
                parts[-1] += [bottom, top]
                filled += volume
                continue
        parts.append([bottom, top])
        filled = volume
    return [_extreme_points(np.concatenate(part)) for part in parts]


def surface(loft: Loft, *, lying: bool = False) -> Mapping[str, Float[np.ndarray, "_ 3 3"]]:
    """Triangles (m) of the loft's closed surface by material."""
    rings = [station.ring(_angles(VISUAL_CORNERS, lying)) for station in loft]
    strips: dict[str, list[Float[np.ndarray, "_ 3 3"]]] = {}
    for station, lower, upper in zip(loft, rings, rings[1:], strict=False):
        strips.setdefault(station.material, []).append(strip(lower, upper))
    for station, inner, outer in (
        (loft[0], _centre_of(rings[0]), rings[0]),
        (loft[-1], rings[-1], _centre_of(rings[-1])),
    ):
        strips.setdefault(station.material, []).append(strip(inner, outer))
    return {material: np.concatenate(triangles) for material, triangles in strips.items()}


def strip(lower: Float[np.ndarray, "n 3"], upper: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "m 3 3"]:
    """Triangles between two rings, facing outwards; those without an area are left out."""
    lower_next, upper_next = np.roll(lower, -1, axis=0), np.roll(upper, -1, axis=0)
    triangles = np.concatenate(
        (np.stack((lower, lower_next, upper_next), axis=1), np.stack((lower, upper_next, upper), axis=1))
    )
    edges = triangles[:, 1:] - triangles[:, :1]
    return triangles[np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) > 1e-14]


def _angles(corners: int, lying: bool) -> Float[np.ndarray, "n"]:
    return (np.arange(corners) + lying / 2) * 2 * np.pi / corners


def _outline(station: Station, lying: bool) -> Float[np.ndarray, "n 3"]:
    if math.isinf(station.roundness):
        return station.ring(np.pi / 4 + _angles(4, False))
    return station.ring(_angles(COLLISION_CORNERS, lying))


def _centre_of(ring: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    return np.broadcast_to(ring.mean(axis=0), ring.shape)


def _extreme_points(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "m 3"]:
    return points[np.sort(ConvexHull(points).vertices)]
