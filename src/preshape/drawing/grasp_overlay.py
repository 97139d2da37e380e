"""Grasps drawn into the view: the outline of the palm and the chain of each finger."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw
from scipy.spatial import ConvexHull

from preshape.geometry.camera import Camera
from preshape.hands.kinematics import HandKinematics

SUPERSAMPLING = 2
NEAREST_M = 0.05
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


def grasp_overlay(
    rgb: UInt8[np.ndarray, "h w 3"],
    camera: Camera,
    hand: HandKinematics,
    *,
    initial: Float[np.ndarray, "d"] | None = None,
    planned: Float[np.ndarray, "d"] | None = None,
    scale: int = 2,
) -> UInt8[np.ndarray, "scaled_h scaled_w 3"]:
    """The view with the hand drawn at a grasp: initial in dashed orange, planned in thick blue.

    Args:
        rgb: the view.
        camera: its camera.
        hand: kinematics of the hand.
        initial, planned: grasps theta in the camera frame. None, NaN and a hand behind the camera are not
            drawn.
        scale: how many times the picture is larger than the view.
    """
    pixels = scale * SUPERSAMPLING
    size = (rgb.shape[1] * pixels, rgb.shape[0] * pixels)
    canvas = _Canvas(Image.fromarray(rgb).resize(size, Image.Resampling.BICUBIC), pixels)
    drawn = []
    for name, theta, style in (("initial", initial, INITIAL_STYLE), ("planned", planned, PLANNED_STYLE)):
        if theta is not None:
            _draw_hand(canvas, camera, hand, theta, style)
            drawn.append((name, style))
    if drawn:
        _draw_legend(canvas, drawn)
    small = canvas.image.resize((rgb.shape[1] * scale, rgb.shape[0] * scale), Image.Resampling.LANCZOS)
    return np.array(small)


class _Canvas:
    """A picture that is drawn on in pixels of the view, whatever its own resolution."""

    def __init__(self, image: Image.Image, pixels: int) -> None:
        self.image = image
        self.pixels = pixels
        self._draw = ImageDraw.Draw(image, "RGBA")

    def line(self, points: list[Point], style: LineStyle) -> None:
        """Line through points, with a white border that sets it off from any background."""
        pieces = list(_dashes(points)) if style.dashed else [points]
        for colour, width in ((WHITE, style.width_px + 1.5), (style.colour, style.width_px)):
            for piece in pieces:
                self._draw.line(self._scaled(piece), colour, round(width * self.pixels), joint="curve")

    def dot(self, point: Point, radius_px: float, colour: Colour) -> None:
        """Filled circle with a white border."""
        for fill, radius in ((WHITE, radius_px + 0.75), (colour, radius_px)):
            self._draw.circle(self._scaled([point])[0], radius * self.pixels, fill)

    def area(self, points: list[Point], colour: Colour, opacity: float) -> None:
        """Polygon that lets the view shine through."""
        self._draw.polygon(self._scaled(points), (*colour, round(255 * opacity)))

    def text(self, point: Point, text: str, colour: Colour, size_px: float) -> None:
        """Text with its left middle at a point."""
        self._draw.text(self._scaled([point])[0], text, colour, font_size=size_px * self.pixels, anchor="lm")

    def _scaled(self, points: list[Point]) -> list[Point]:
        return [((u + 0.5) * self.pixels, (v + 0.5) * self.pixels) for u, v in points]


def _draw_hand(
    canvas: _Canvas,
    camera: Camera,
    hand: HandKinematics,
    theta: Float[np.ndarray, "d"],
    style: LineStyle,
) -> None:
    batch = torch.as_tensor(theta, dtype=torch.float64)[None]
    with torch.no_grad():
        palm, fingers = hand.palm_corners(batch)[0].numpy(), hand.finger_points(batch)[0].numpy()
    nearest = np.min([palm[:, 2].min(), fingers[..., 2].min()])
    if not nearest > NEAREST_M:
        return  # behind the camera, where nothing projects into the view, or nowhere (NaN)
    corners = np.stack(camera.project(palm), axis=-1)
    outline = _points(corners[ConvexHull(corners).vertices])
    canvas.area(outline, style.colour, 0.25)
    canvas.line([*outline, outline[0]], style)
    for finger in fingers:
        chain = _points(np.stack(camera.project(finger), axis=-1))
        canvas.line(chain, style)
        for joint in chain[:-1]:
            canvas.dot(joint, 0.8 * style.width_px, style.colour)
        canvas.dot(chain[-1], 1.3 * style.width_px, style.colour)


def _draw_legend(canvas: _Canvas, drawn: list[tuple[str, LineStyle]]) -> None:
    """One line for each grasp drawn, in the lower left corner."""
    bottom = canvas.image.height / canvas.pixels - LEGEND_ROW_PX
    top, right = bottom - LEGEND_ROW_PX * len(drawn), 90.0
    canvas.area([(0.0, top), (right, top), (right, bottom), (0.0, bottom)], WHITE, 0.8)
    for row, (name, style) in enumerate(drawn):
        height = top + LEGEND_ROW_PX * (row + 0.5)
        canvas.line([(8.0, height), (34.0, height)], style)
        canvas.text((40.0, height), name, (0, 0, 0), 11.0)


def _points(pixels: Float[np.ndarray, "n 2"]) -> list[Point]:
    return [(float(u), float(v)) for u, v in pixels]


def _dashes(points: list[Point]) -> Iterator[list[Point]]:
    """Dashes along a line through points, each dash straight."""
    for start, end in pairwise(points):
        a, b = np.array(start), np.array(end)
        length = float(np.linalg.norm(b - a))
        for begin in np.arange(0.0, length, DASH_PX + GAP_PX):
            shares = np.array([begin, min(begin + DASH_PX, length)]) / length
            yield _points(a + shares[:, None] * (b - a))
