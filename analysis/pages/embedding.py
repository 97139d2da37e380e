"""Pictures as text, so that a page needs no other file."""

import base64
import io
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from matplotlib.figure import Figure
from PIL import Image

from preshape.errors import InputError

QUALITY = 82
"""Of WebP, 0-100."""


def embedded_picture(picture: UInt8[np.ndarray, "h w 3"]) -> str:
    """Data URI of a picture."""
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, format="WEBP", quality=QUALITY, method=4)
    return _data_uri(buffer.getvalue())


def embedded_figure(figure: Figure) -> str:
    """Data URI of a figure."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="webp", dpi=100, pil_kwargs={"quality": QUALITY})
    return _data_uri(buffer.getvalue())


def embedded_vector(svg: bytes) -> str:
    """Data URI of a drawing."""
    return _data_uri(svg, "image/svg+xml")


def embedded_file(path: Path) -> str:
    """Data URI of a WebP or PNG file; raises InputError if it cannot be read."""
    try:
        return _data_uri(path.read_bytes(), f"image/{path.suffix.removeprefix('.')}")
    except OSError as error:
        problem = f"The picture cannot be read: {error.strerror}"
        raise InputError(problem, where=path, fix="check the path") from error


def _data_uri(content: bytes, kind: str = "image/webp") -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"
