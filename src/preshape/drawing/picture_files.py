"""Writing pictures."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from matplotlib.figure import Figure
from PIL import Image

from preshape.files import atomic_path


def save_picture(path: str | Path, picture: UInt8[np.ndarray, "h w 3"] | Figure) -> None:
    """Write a picture or a figure as PNG, atomically.

    Raises:
        InputError: the place cannot be written to.
    """
    with atomic_path(path) as temporary:
        if isinstance(picture, Figure):
            picture.savefig(temporary, format="png", dpi=100)
        else:
            Image.fromarray(picture).save(temporary, format="png")
