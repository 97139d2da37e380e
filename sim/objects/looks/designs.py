"""Designs of labels, as data: where colour fields, brand, picture and product go."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

Fractions = tuple[float, float, float, float]
"""Left, top, right and bottom in fractions of a print."""


@dataclass(frozen=True)
class Layout:
    """Where things go on a front.

    Args:
        fields: "area" or "disc" of the second colour, and the corners, or centre and radii, in fractions.
        brand, picture, product: their places; a brand `on_field` stands on the second colour, as a product.
    """

    fields: Sequence[tuple[str, Sequence[tuple[float, float]]]]
    brand: Fractions
    picture: Fractions
    product: Fractions
    brand_on_field: bool = True
    product_on_field: bool = False


_STAR = tuple(
    (0.5 + 0.49 * r * np.cos(k * np.pi / 16), 0.29 + 0.27 * r * np.sin(k * np.pi / 16))
    for k, r in enumerate((1.0, 0.84) * 16)
)
STYLES: Mapping[str, Layout] = {
    "band": Layout(
        [("area", ((0, 0), (1, 0), (1, 0.35), (0, 0.35))), ("area", ((0, 0.97), (1, 0.97), (1, 1), (0, 1)))],
        brand=(0.06, 0.04, 0.94, 0.32),
        picture=(0.08, 0.37, 0.92, 0.7),
        product=(0.05, 0.71, 0.95, 0.96),
    ),
    "oval": Layout(
        [("disc", ((0.5, 0.25), (0.49, 0.22)))],
        brand=(0.13, 0.11, 0.87, 0.39),
        picture=(0.12, 0.68, 0.88, 0.98),
        product=(0.06, 0.49, 0.94, 0.67),
    ),
    "sash": Layout(
        [("area", ((0, 0.42), (1, 0.33), (1, 0.62), (0, 0.71)))],
        brand=(0.05, 0.04, 0.95, 0.33),
        picture=(0.12, 0.69, 0.88, 0.99),
        product=(0.06, 0.41, 0.94, 0.63),
        brand_on_field=False,
        product_on_field=True,
    ),
    "hill": Layout(
        [("disc", ((0.5, 1.02), (1.0, 0.46)))],
        brand=(0.05, 0.03, 0.95, 0.29),
        picture=(0.12, 0.62, 0.88, 0.98),
        product=(0.06, 0.3, 0.94, 0.54),
        brand_on_field=False,
    ),
    "half": Layout(
        [("area", ((0, 0.0), (1, 0.0), (1, 0.48), (0, 0.48)))],
        brand=(0.05, 0.04, 0.95, 0.28),
        picture=(0.12, 0.51, 0.88, 0.98),
        product=(0.06, 0.28, 0.94, 0.46),
        product_on_field=True,
    ),
    "frame": Layout(
        [("area", ((0, 0), (1, 0), (1, 0.07), (0, 0.07))), ("area", ((0, 0.93), (1, 0.93), (1, 1), (0, 1)))],
        brand=(0.06, 0.1, 0.94, 0.36),
        picture=(0.16, 0.38, 0.84, 0.64),
        product=(0.06, 0.65, 0.94, 0.91),
        brand_on_field=False,
    ),
    "burst": Layout(
        [("area", _STAR)],
        brand=(0.16, 0.13, 0.84, 0.45),
        picture=(0.12, 0.71, 0.88, 0.98),
        product=(0.06, 0.57, 0.94, 0.71),
    ),
    "plain": Layout([], (0.04, 0.1, 0.96, 0.66), (0, 0, 0, 0), (0.1, 0.66, 0.9, 0.94), False),
}
"""Designs by name."""
BESIDE = Layout(
    [("area", ((0, 0), (0.3, 0), (0.24, 1), (0, 1)))],
    brand=(0.31, 0.06, 0.98, 0.56),
    picture=(0.02, 0.08, 0.24, 0.92),
    product=(0.31, 0.58, 0.98, 0.94),
    brand_on_field=False,
)
"""Replaces the design on wide prints with a picture."""
