"""Text that fills a rectangle, in the fonts that come with matplotlib."""

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import matplotlib
from PIL import Image, ImageDraw, ImageFont

FONTS: Mapping[str, str] = {
    "sans": "DejaVuSans-Bold.ttf",
    "serif": "DejaVuSerif-Bold.ttf",
    "slanted": "DejaVuSans-BoldOblique.ttf",
}
"""Files by the name of the lettering."""
DRAWN_PX = 40
"""Size at which letters are drawn before they are brought to size."""
PITCH_PX = 39
EDGE_PX = 3
NARROWEST, WIDEST = 0.55, 1.15
"""Width of the letters over their own at the same height."""
MOST_LINES = 4

Box = tuple[float, float, float, float]
"""Left, top, right and bottom in pixels."""


def write(picture: Image.Image, text: str, box: Box, letters: str, ink: str, edge: str | None = None) -> None:
    """Write the text into the box, in as many lines as make it largest; `edge` is an outline's colour."""
    width, height = box[2] - box[0], box[3] - box[1]
    if not text or width < 4 or height < 4:
        return
    font, stroke = _font(letters), 0 if edge is None else EDGE_PX
    ways = list(_ways_to_break(text.split()))
    sizes = [_own_size(lines, font, stroke) for lines in ways]
    scales = [min(height / own[1], width / (own[0] * NARROWEST)) for own in sizes]
    scale, lines, own = max(zip(scales, ways, sizes, strict=True))
    stretch = min(WIDEST, width / (own[0] * scale))
    size = max(1, round(own[0] * scale * stretch)), max(1, round(own[1] * scale))
    block = _block(lines, own, font, ink, edge, stroke).resize(size)
    corner = (round(box[0] + (width - size[0]) / 2), round(box[1] + (height - size[1]) / 2))
    picture.paste(block, corner, block)


def _own_size(lines: tuple[str, ...], font: ImageFont.FreeTypeFont, stroke: int) -> tuple[int, int]:
    width = max(font.getlength(line) for line in lines)
    return round(width) + 2 * stroke, len(lines) * (PITCH_PX + 2 * stroke)


def _ways_to_break(words: list[str]) -> Iterator[tuple[str, ...]]:
    for count in range(1, min(len(words), MOST_LINES) + 1):
        for places in combinations(range(1, len(words)), count - 1):
            edges = (0, *places, len(words))
            yield tuple(" ".join(words[a:b]) for a, b in pairwise(edges))


@cache
def _font(letters: str) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / FONTS[letters], DRAWN_PX)


def _block(
    lines: tuple[str, ...],
    size: tuple[int, int],
    font: ImageFont.FreeTypeFont,
    ink: str,
    edge: str | None,
    stroke: int,
) -> Image.Image:
    block = Image.new("RGBA", size)
    draw = ImageDraw.Draw(block)
    for number, line in enumerate(lines):
        place = (size[0] / 2, (number + 0.5) * size[1] / len(lines))
        draw.text(place, line, ink, font, anchor="mm", stroke_width=stroke, stroke_fill=edge)
    return block
