"""The labelled rectangles of an image: `pcdNNNNcpos.txt` and `pcdNNNNcneg.txt`."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from jaxtyping import Float

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.rectangle import GraspRectangle, misfit_px
from preshape.cornell.text_files import damaged, read_lines

MAX_MISFIT_PX = 5.0
"""Vertices may be so far from a rectangle's: they are rounded, by half a pixel on real data."""


class Flaw(StrEnum):
    """Why a labelled rectangle cannot be used."""

    NO_NUMBER = "with vertices that are no numbers"
    OFF_IMAGE = "beyond the image"
    NO_RECTANGLE = "that are no rectangles"


@dataclass(frozen=True)
class LabelledRectangles:
    """The rectangles of one file.

    Args:
        usable: in the file's order.
        dropped: the flaw of each rectangle that is left out.
    """

    usable: tuple[GraspRectangle, ...]
    dropped: tuple[Flaw, ...]


def read_rectangles(path: Path) -> LabelledRectangles:
    """Read four lines `u v` (pixels) for each rectangle; their order round it may be either.

    A rectangle is left out if a vertex is no number or lies beyond the image, or if its vertices are more
    than `MAX_MISFIT_PX` from those of a rectangle. An image without negatives has an empty file.

    Raises:
        InputError: if the file cannot be read, is truncated or holds anything else.
    """
    vertices = [_vertex(path, line) for line in read_lines(path)]
    if len(vertices) % 4:
        raise damaged(path, f"{len(vertices)} vertices cannot be those of rectangles, which have four each")
    corners = np.array(vertices, dtype=np.float64).reshape(-1, 4, 2)
    flaws = [_flaw(own) for own in corners]
    usable = (
        GraspRectangle.from_corners(own) for own, flaw in zip(corners, flaws, strict=True) if flaw is None
    )
    return LabelledRectangles(tuple(usable), tuple(flaw for flaw in flaws if flaw is not None))


def _vertex(path: Path, line: str) -> Sequence[float]:
    try:
        u, v = map(float, line.split())
    except ValueError as error:
        raise damaged(path, f"{line.strip()[:40]!r} is not a vertex `u v`") from error
    return u, v


def _flaw(corners: Float[np.ndarray, "4 2"]) -> Flaw | None:
    if not np.isfinite(corners).all():
        return Flaw.NO_NUMBER
    if (corners < -0.5).any() or (corners > np.array([WIDTH, HEIGHT]) - 0.5).any():
        return Flaw.OFF_IMAGE
    return Flaw.NO_RECTANGLE if misfit_px(corners) > MAX_MISFIT_PX else None
