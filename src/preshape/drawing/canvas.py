"""A view that is drawn on: lines, dots, areas and a legend, in pixels of the view."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw

SUPERSAMPLING = 2
DASH_PX = 6.0
GAP_PX = 4.0
LEGEND_ROW_PX = 16.0

Colour = tuple[int, int, int]
Point = tuple[float, float]
WHITE: Colour = (255, 255, 255)


@dataclass(frozen=True)
class LineStyle:
    """How a grasp is drawn.

    Args:
        colour: colour of its lines.
        width_px: width of its lines, in pixels of the view.
        dashed: whether its lines are dashed, so that it can be told without colours.
    """

    colour: Colour
    width_px: float
    dashed: bool


# Orange and blue of Okabe and Ito's palette, which all kinds of colour vision tell apart.
INITIAL_STYLE = LineStyle((230, 159, 0), 1.5, dashed=True)
PLANNED_STYLE = LineStyle((0, 90, 181), 3.0, dashed=False)


class Canvas:
    """A picture that is drawn on in pixels of the view, whatever its own resolution.

    Args:
        rgb: the view.
        scale: how many times the picture is larger than the view.
    """

    def __init__(self, rgb: UInt8[np.ndarray, "h w 3"], scale: int) -> None:
        self._size = (rgb.shape[1] * scale, rgb.shape[0] * scale)
        self._pixels = scale * SUPERSAMPLING
        size = (rgb.shape[1] * self._pixels, rgb.shape[0] * self._pixels)
        self._image = Image.fromarray(rgb).resize(size, Image.Resampling.BICUBIC)
        self._draw = ImageDraw.Draw(self._image, "RGBA")

    def line(self, points: list[Point], style: LineStyle) -> None:
        """Line through points, with a white border that sets it off from any background."""
        pieces = list(_dashes(points)) if style.dashed else [points]
        for colour, width in ((WHITE, style.width_px + 1.5), (style.colour, style.width_px)):
            for piece in pieces:
                self._draw.line(self._scaled(piece), colour, round(width * self._pixels), joint="curve")

    def dot(self, point: Point, radius_px: float, colour: Colour) -> None:
        """Filled circle with a white border."""
        for fill, radius in ((WHITE, radius_px + 0.75), (colour, radius_px)):
            self._draw.circle(self._scaled([point])[0], radius * self._pixels, fill)

    def area(self, points: list[Point], colour: Colour, opacity: float) -> None:
        """Polygon that lets the view shine through."""
        self._draw.polygon(self._scaled(points), (*colour, round(255 * opacity)))

    def text(self, point: Point, text: str, colour: Colour, size_px: float) -> None:
        """Text with its left middle at a point."""
        self._draw.text(self._scaled([point])[0], text, colour, font_size=size_px * self._pixels, anchor="lm")

    def legend(self, drawn: Sequence[tuple[str, LineStyle]]) -> None:
        """One line for each name, in the lower left corner."""
        bottom = self._image.height / self._pixels - LEGEND_ROW_PX
        top, right = bottom - LEGEND_ROW_PX * len(drawn), 90.0
        self.area([(0.0, top), (right, top), (right, bottom), (0.0, bottom)], WHITE, 0.8)
        for row, (name, style) in enumerate(drawn):
            height = top + LEGEND_ROW_PX * (row + 0.5)
            self.line([(8.0, height), (34.0, height)], style)
            self.text((40.0, height), name, (0, 0, 0), 11.0)

    def picture(self) -> UInt8[np.ndarray, "scaled_h scaled_w 3"]:
        """What was drawn."""
        return np.array(self._image.resize(self._size, Image.Resampling.LANCZOS))

    def _scaled(self, points: list[Point]) -> list[Point]:
        return [((u + 0.5) * self._pixels, (v + 0.5) * self._pixels) for u, v in points]


def points_of(pixels: Float[np.ndarray, "n 2"]) -> list[Point]:
    """Pixels (u, v) as points."""
    return [(float(u), float(v)) for u, v in pixels]


def _dashes(points: list[Point]) -> Iterator[list[Point]]:
    """Dashes along a line through points, each dash straight."""
    for start, end in pairwise(points):
        a, b = np.array(start), np.array(end)
        length = float(np.linalg.norm(b - a))
        for begin in np.arange(0.0, length, DASH_PX + GAP_PX):
            shares = np.array([begin, min(begin + DASH_PX, length)]) / length
            yield points_of(a + shares[:, None] * (b - a))
