"""Simple pictures of what is in a package, as shapes in a unit square with y pointing down."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from PIL import ImageDraw

from sim.objects.looks.lettering import Box

TABLE = Path(__file__).with_name("pictograms.csv")


@dataclass(frozen=True)
class Mark:
    """One shape of a picture.

    Args:
        shape: "disc" (centre and radii), "area" (corners) or "stroke" (points of a line).
        colour: sRGB "#rrggbb".
        width: of a stroke.
        points: x and y in the unit square.
    """

    shape: str
    colour: str
    width: float
    points: tuple[tuple[float, float], ...]


def _mark(row: Mapping[str, str]) -> Mark:
    numbers = [float(number) for number in row["points"].split()]
    points = tuple(zip(numbers[::2], numbers[1::2], strict=True))
    return Mark(row["shape"], row["colour"], float(row["width"]), points)


@cache
def read_pictograms() -> Mapping[str, tuple[Mark, ...]]:
    """The pictures by name."""
    pictures: dict[str, tuple[Mark, ...]] = {}
    with TABLE.open(newline="") as file:
        for row in csv.DictReader(file):
            pictures[row["picture"]] = (*pictures.get(row["picture"], ()), _mark(row))
    return pictures


def draw_pictogram(draw: ImageDraw.ImageDraw, name: str, box: Box) -> None:
    """Draw a picture as large as fits into the middle of the box."""
    side = min(box[2] - box[0], box[3] - box[1])
    left, top = (box[0] + box[2] - side) / 2, (box[1] + box[3] - side) / 2
    for mark in read_pictograms()[name]:
        points = [(left + x * side, top + y * side) for x, y in mark.points]
        if mark.shape == "disc":
            (x, y), (rx, ry) = points[0], mark.points[1]
            draw.ellipse((x - rx * side, y - ry * side, x + rx * side, y + ry * side), mark.colour)
        elif mark.shape == "area":
            draw.polygon(points, mark.colour)
        else:
            draw.line(points, mark.colour, max(1, round(mark.width * side)), joint="curve")
