"""Colours: files hold sRGB, the renderer calculates in linear RGB."""

import numpy as np
from jaxtyping import Num

LinearColour = tuple[float, float, float]
"""Linear RGB, 0-1."""


def linear_rgb(encoded: Num[np.ndarray, "3"]) -> LinearColour:
    """Linear RGB of an sRGB colour, 0-255 (IEC 61966-2-1)."""
    share = encoded / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear[0]), float(linear[1]), float(linear[2])


def colour_from_hex(colour: str) -> LinearColour:
    """Linear RGB of an sRGB colour written "#rrggbb"."""
    return linear_rgb(np.frombuffer(bytes.fromhex(colour.removeprefix("#")), np.uint8))
