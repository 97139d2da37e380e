"""What is printed on a package: colour fields, the brand, a picture and the name of the product."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageColor, ImageDraw

from sim.objects.looks.designs import BESIDE, STYLES, Fractions
from sim.objects.looks.lettering import Box, write
from sim.objects.looks.look import Look
from sim.objects.looks.pictograms import draw_pictogram

LONGER_SIDE_PX = 256
SUPERSAMPLING = 2
WIDE = 1.75
"""Prints broader than this, over their height, have the picture beside the text."""
BLACK, WHITE = "#1c1a1c", "#ffffff"


@dataclass(frozen=True)
class Print:
    """A place on the surface that is printed on.

    Args:
        kind: "front" for the whole design, "brand" for the brand alone, "facts" for small print, "rings" for
            decoration, "paper" for the bare colour.
        area: left, top, right, bottom (m) of what is coloured on the unfolded surface.
        middle: the same of what is seen at once, where the text goes.
    """

    kind: str
    area: Box
    middle: Box


def artwork(
    look: Look, size: tuple[float, float], prints: Sequence[Print], ground: str, field: str
) -> UInt8[np.ndarray, "h w 3"]:
    """The texture of an unfolded surface of the size (width and height, m).

    Args:
        look: colours and wording.
        size: of the unfolded surface.
        prints: what is printed where.
        ground, field: materials whose colours are the first and the second of the prints.
    """
    scale = SUPERSAMPLING * LONGER_SIDE_PX / max(size)
    shape = [SUPERSAMPLING * max(1, round(length * scale / SUPERSAMPLING)) for length in size]
    picture = Image.new("RGB", (shape[0], shape[1]), look.colours["body"])
    colours = look.colours[ground], look.colours[field]
    for each in prints:
        left, top, right, bottom = (round(length * scale) for length in each.area)
        paper = Image.new("RGB", (right - left, bottom - top), colours[0])
        middle = tuple(
            length * scale - start for length, start in zip(each.middle, (left, top) * 2, strict=True)
        )
        _DRAWN[each.kind](_Sheet(paper, middle, look, *colours))
        picture.paste(paper, (left, top))
    return np.asarray(picture.reduce(SUPERSAMPLING))


@dataclass(frozen=True, eq=False)
class _Sheet:
    """One print while it is drawn, in pixels."""

    picture: Image.Image
    middle: Box
    look: Look
    ground: str
    field: str

    @property
    def draw(self) -> ImageDraw.ImageDraw:
        return ImageDraw.Draw(self.picture)

    @property
    def area(self) -> Box:
        return 0, 0, self.picture.width, self.picture.height


def _front(sheet: _Sheet) -> None:
    layout, look = STYLES[sheet.look.style], sheet.look
    if look.picture and _aspect(sheet.middle) > WIDE:
        layout = BESIDE
    for shape, points in layout.fields:
        if shape == "area":
            sheet.draw.polygon([_place(sheet.area, point) for point in points], sheet.field)
        else:
            (x, y), (rx, ry) = points
            sheet.draw.ellipse(_part(sheet.middle, (x - rx, y - ry, x + rx, y + ry)), sheet.field)
    if look.picture:
        draw_pictogram(sheet.draw, look.picture, _part(sheet.middle, layout.picture))
    brand, product = (_ink(sheet, on_field) for on_field in (layout.brand_on_field, layout.product_on_field))
    write(sheet.picture, look.brand, _part(sheet.middle, layout.brand), look.letters, brand)
    write(sheet.picture, look.product, _part(sheet.middle, layout.product), "sans", product)


def _brand(sheet: _Sheet) -> None:
    place = _part(sheet.middle, (0.1, 0.12, 0.9, 0.88))
    write(sheet.picture, sheet.look.brand, place, sheet.look.letters, _ink(sheet, False))


def _facts(sheet: _Sheet) -> None:
    """The table of contents of the food, and a bar code."""
    place = _part(sheet.middle, (0.1, 0.04, 0.9, 0.22))
    write(sheet.picture, sheet.look.brand, place, sheet.look.letters, _ink(sheet, False))
    sheet.draw.rectangle(_part(sheet.middle, (0.12, 0.28, 0.88, 0.74)), WHITE, BLACK, 2)
    for row in range(6):
        top = 0.34 + 0.06 * row
        sheet.draw.rectangle(_part(sheet.middle, (0.18, top, 0.5 + 0.05 * (row % 3), top + 0.025)), "#77777a")
        sheet.draw.rectangle(_part(sheet.middle, (0.7, top, 0.82, top + 0.025)), "#77777a")
    sheet.draw.rectangle(_part(sheet.middle, (0.2, 0.8, 0.8, 0.95)), WHITE)
    for bar in range(9):
        left = 0.26 + 0.055 * bar
        sheet.draw.rectangle(_part(sheet.middle, (left, 0.82, left + 0.012 * (1 + bar % 3), 0.93)), BLACK)


def _rings(sheet: _Sheet) -> None:
    """What a plate is decorated with."""
    for reach, colour in (
        (0.47, sheet.field),
        (0.45, sheet.ground),
        (0.42, sheet.field),
        (0.415, sheet.ground),
    ):
        box = _part(sheet.middle, (0.5 - reach, 0.5 - reach, 0.5 + reach, 0.5 + reach))
        sheet.draw.ellipse(box, colour)


def _paper(sheet: _Sheet) -> None:
    """Nothing is printed."""


_DRAWN = {"paper": _paper, "front": _front, "brand": _brand, "facts": _facts, "rings": _rings}


def _ink(sheet: _Sheet, on_field: bool) -> str:
    """The other colour of the package if it can be read, else black or white."""
    paper, other = (sheet.field, sheet.ground) if on_field else (sheet.ground, sheet.field)
    if abs(_brightness(paper) - _brightness(other)) > 0.4:
        return other
    return WHITE if _brightness(paper) < 0.6 else BLACK


def _brightness(colour: str) -> float:
    red, green, blue = ImageColor.getrgb(colour)[:3]
    return (0.3 * red + 0.59 * green + 0.11 * blue) / 255


def _aspect(box: Box) -> float:
    return (box[2] - box[0]) / (box[3] - box[1])


def _place(box: Box, point: tuple[float, float]) -> tuple[float, float]:
    return box[0] + point[0] * (box[2] - box[0]), box[1] + point[1] * (box[3] - box[1])


def _part(box: Box, fractions: Fractions) -> Box:
    return (*_place(box, (fractions[0], fractions[1])), *_place(box, (fractions[2], fractions[3])))
