"""From proportions, in fractions of an object's size, to the solid of one object.

A profile is a list of lofts, a loft a list of rows: cross-sections from bottom to top. Oval bottles have
round caps, so a row may leave out its depth and be round.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from sim.objects.loft import Loft, Station, convex_parts, surface

BOX = math.inf
"""Roundness of a cross-section with sharp corners."""
ROUND = 2.0
OVAL = 2.5
PILLOW = 3.0
SOFT = 4.0

Size = tuple[float, float, float]
"""Along x, y and z (m)."""


@dataclass(frozen=True, eq=False)
class Solid:
    """What an object collides as and what its walls are of.

    Args:
        parts: vertices (m) of convex parts.
        walls: triangles (m) of the closed surface by material.
    """

    parts: tuple[Float[np.ndarray, "_ 3"], ...]
    walls: Mapping[str, Float[np.ndarray, "_ 3 3"]]


class PackageShape(Protocol):
    """A shape family."""

    def solid(self, size: Size) -> Solid:
        """The solid that fills a box of the size, resting on z = 0."""
        ...


@dataclass(frozen=True)
class Row:
    """One cross-section of a profile, in fractions of the object's size.

    Args:
        height: fraction of the object's height.
        width, depth: fractions of its size along x and y; `depth` None means a round section whose
            diameter is `width` times the smaller of the two sizes.
        roundness: as in `Station`.
        material: what the wall is of from here upwards.
        offset: centre along y, as a fraction of the size along y.
    """

    height: float
    width: float
    depth: float | None
    roundness: float
    material: str
    offset: float = 0.0


Profile = tuple[tuple[Row, ...], ...]
"""One or more lofts."""


@dataclass(frozen=True)
class Standing:
    """A package whose sections are stacked from the table upwards."""

    profile: Profile

    def solid(self, size: Size) -> Solid:
        """The solid that fills a box of the size, resting on z = 0."""
        lofts = _lofts(self.profile, size)
        parts = tuple(part for loft in lofts for part in convex_parts(loft))
        return Solid(parts, _joined([surface(loft) for loft in lofts]))


@dataclass(frozen=True)
class Lying:
    """A package whose sections follow one another along y; a row's depth and offset are heights."""

    profile: Profile

    def solid(self, size: Size) -> Solid:
        """The solid that fills a box of the size, resting on z = 0."""
        width, length, height = size
        lofts = _lofts(self.profile, (width, height, length))
        parts = tuple(_laid(part, size) for loft in lofts for part in convex_parts(loft, lying=True))
        walls = _joined([surface(loft, lying=True) for loft in lofts])
        return Solid(parts, {material: _laid(triangles, size) for material, triangles in walls.items()})


def banded(roundness: float, *rows: tuple[float, float, str]) -> tuple[Row, ...]:
    """Rows of one roundness whose width and depth shrink alike: (height, scale, material)."""
    return tuple(Row(height, scale, scale, roundness, material) for height, scale, material in rows)


def round_rows(*rows: tuple[float, float, str]) -> tuple[Row, ...]:
    """Round rows: (height, diameter, material)."""
    return tuple(Row(height, diameter, None, ROUND, material) for height, diameter, material in rows)


def _lofts(profile: Profile, size: Size) -> list[Loft]:
    width, depth, height = size
    diameter = min(width, depth)
    return [
        [
            Station(
                row.height * height,
                row.width * (diameter if row.depth is None else width),
                row.width * diameter if row.depth is None else row.depth * depth,
                row.roundness,
                row.material,
                row.offset * depth,
            )
            for row in rows
        ]
        for rows in profile
    ]


def _laid(points: Float[np.ndarray, "*n 3"], size: Size) -> Float[np.ndarray, "*n 3"]:
    """A quarter turn about x: what pointed along y points up, what pointed up points along -y."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack((x, size[1] / 2 - z, y + size[2] / 2), axis=-1)


def _joined(
    surfaces: list[Mapping[str, Float[np.ndarray, "_ 3 3"]]],
) -> Mapping[str, Float[np.ndarray, "_ 3 3"]]:
    materials = dict.fromkeys(material for walls in surfaces for material in walls)
    return {
        material: np.concatenate([walls[material] for walls in surfaces if material in walls])
        for material in materials
    }
