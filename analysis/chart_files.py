"""Charts as small picture files."""

import io
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from preshape.files import atomic_path

COLOURS = 64
"""Colours that are kept; charts have few, and a short palette makes their files several times smaller."""


def save_chart(figure: Figure, path: Path, dpi: int = 110) -> None:
    """Write a chart as PNG, atomically; raises InputError if the place cannot be written to."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi)
    with Image.open(buffer) as picture, atomic_path(path) as temporary:
        small = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        small.save(temporary, format="PNG", optimize=True)
