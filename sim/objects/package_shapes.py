"""From a profile, in fractions of an object's size, to the lofts of one object.

A profile is a list of lofts, a loft a list of rows: cross-sections from bottom to top. Oval bottles have
round caps, so a row may leave out its depth and be round.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from sim.objects.colour import LinearColour
from sim.objects.loft import Loft, Station


@dataclass(frozen=True)
class Row:
    """One cross-section of a profile, in fractions of the object's size.

    Args:
        height: fraction of the object's height.
        width, depth: fractions of its size along x and y; `depth` None means a round section whose
            diameter is `width` times the smaller of the two sizes.
        roundness: as in `Station`.
        material: key of the object's colours; paints the wall from here upwards.
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


def lofts(
    profile: Profile, size: tuple[float, float, float], colours: Mapping[str, LinearColour]
) -> list[Loft]:
    """The lofts of a profile at the given size along x, y, z (m); stands on z = 0."""
    width, depth, height = size
    diameter = min(width, depth)
    return [
        [
            Station(
                row.height * height,
                row.width * (diameter if row.depth is None else width),
                row.width * diameter if row.depth is None else row.depth * depth,
                row.roundness,
                colours[row.material],
                row.offset * depth,
            )
            for row in rows
        ]
        for rows in profile
    ]
