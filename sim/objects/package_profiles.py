"""Profiles of everyday packages: the shape families of generated objects, as data."""

import math
from collections.abc import Mapping

from sim.objects.package_shapes import Profile, Row

BOX = math.inf
"""Roundness of a cross-section with sharp corners."""
ROUND = 2.0
OVAL = 2.5
SOFT = 4.0


def _banded(roundness: float, *rows: tuple[float, float, str]) -> tuple[Row, ...]:
    """Rows of one roundness whose width and depth shrink alike: (height, scale, material)."""
    return tuple(Row(height, scale, scale, roundness, material) for height, scale, material in rows)


def _round(*rows: tuple[float, float, str]) -> tuple[Row, ...]:
    """Round rows: (height, diameter, material)."""
    return tuple(Row(height, diameter, None, ROUND, material) for height, diameter, material in rows)


PROFILES: Mapping[str, Profile] = {
    "box": (_banded(BOX, (0, 1, "body"), (0.22, 1, "label"), (0.72, 1, "body"), (1, 1, "body")),),
    # A tin: rims of bare metal around a paper label.
    "can": (
        _banded(
            ROUND,
            (0, 0.95, "rim"),
            (0.015, 1, "rim"),
            (0.05, 1, "body"),
            (0.3, 1, "label"),
            (0.75, 1, "body"),
            (0.95, 1, "rim"),
            (0.985, 1, "rim"),
            (1, 0.95, "rim"),
        ),
    ),
    # A tin with rounded rectangular walls.
    "flat_can": (
        _banded(
            SOFT,
            (0, 0.97, "rim"),
            (0.03, 1, "rim"),
            (0.07, 1, "body"),
            (0.3, 1, "label"),
            (0.75, 1, "body"),
            (0.93, 1, "rim"),
            (0.97, 1, "rim"),
            (1, 0.97, "rim"),
        ),
    ),
    "drink_can": (
        _banded(
            ROUND,
            (0, 0.78, "rim"),
            (0.07, 1, "body"),
            (0.3, 1, "label"),
            (0.68, 1, "body"),
            (0.9, 1, "rim"),
            (0.97, 0.84, "rim"),
            (1, 0.84, "rim"),
        ),
    ),
    # A cardboard tube with a metal foot and a plastic lid.
    "snack_can": (
        _banded(
            ROUND,
            (0, 0.97, "rim"),
            (0.02, 0.97, "body"),
            (0.25, 0.97, "label"),
            (0.7, 0.97, "body"),
            (0.965, 1, "cap"),
            (1, 1, "cap"),
        ),
    ),
    "spray_can": (
        _round(
            (0, 0.97, "rim"),
            (0.015, 1, "body"),
            (0.2, 1, "label"),
            (0.6, 1, "body"),
            (0.72, 1, "rim"),
            (0.76, 0.84, "cap"),
            (0.97, 0.78, "cap"),
            (1, 0.7, "cap"),
        ),
    ),
    # Broad oval body, short neck, round screw cap.
    "oval_bottle": (
        (
            *_banded(
                OVAL,
                (0, 0.93, "body"),
                (0.03, 1, "body"),
                (0.12, 1, "label"),
                (0.6, 1, "body"),
                (0.7, 0.97, "body"),
            ),
            *_round((0.82, 0.62, "body"), (0.84, 0.6, "cap"), (0.98, 0.58, "cap"), (1, 0.5, "cap")),
        ),
    ),
    # Flat-shouldered bottle with a broad flip-top cap, as shampoo has.
    "flip_top_bottle": (
        (
            *_banded(
                OVAL,
                (0, 0.92, "body"),
                (0.03, 1, "body"),
                (0.15, 1, "label"),
                (0.62, 1, "body"),
                (0.76, 0.92, "body"),
            ),
            Row(0.83, 0.72, 0.66, OVAL, "cap"),
            Row(0.98, 0.68, 0.6, OVAL, "cap"),
            Row(1, 0.6, 0.54, OVAL, "cap"),
        ),
    ),
    # Slim bottle with a long neck, as hot sauce has.
    "sauce_bottle": (
        _round(
            (0, 0.93, "body"),
            (0.03, 1, "body"),
            (0.08, 1, "label"),
            (0.48, 1, "body"),
            (0.55, 0.94, "body"),
            (0.68, 0.5, "body"),
            (0.78, 0.42, "collar"),
            (0.8, 0.56, "cap"),
            (0.97, 0.6, "cap"),
            (1, 0.52, "cap"),
        ),
    ),
    # Waisted bottle with a tall cap, as syrup and creamer have.
    "waisted_bottle": (
        (
            *_banded(
                OVAL,
                (0, 0.94, "body"),
                (0.03, 1, "body"),
                (0.1, 1, "label"),
                (0.4, 0.97, "body"),
                (0.52, 0.84, "body"),
                (0.64, 0.9, "body"),
                (0.72, 0.86, "body"),
            ),
            *_round((0.85, 0.56, "body"), (0.86, 0.56, "cap"), (0.98, 0.52, "cap"), (1, 0.44, "cap")),
        ),
    ),
    # Soap dispenser: oval body, collar, pump head with a spout towards +y.
    "pump_bottle": (
        (
            *_banded(
                OVAL,
                (0, 0.95, "body"),
                (0.03, 1, "body"),
                (0.12, 1, "label"),
                (0.52, 1, "body"),
                (0.62, 0.92, "body"),
            ),
            *_round((0.7, 0.62, "cap"), (0.8, 0.58, "cap"), (0.81, 0.24, "cap"), (0.9, 0.24, "cap")),
        ),
        (
            Row(0.9, 0.5, 0.48, SOFT, "cap", 0.1),
            Row(0.97, 0.5, 0.5, SOFT, "cap", 0.11),
            Row(1, 0.4, 0.42, SOFT, "cap", 0.11),
        ),
    ),
    # Jug: broad foot, a column that carries the neck, and a handle beside it, open between the two.
    "jug": (
        (
            *_banded(
                SOFT,
                (0, 0.93, "body"),
                (0.03, 1, "body"),
                (0.08, 1, "label"),
                (0.46, 1, "body"),
                (0.52, 0.98, "body"),
            ),
        ),
        (
            Row(0.52, 0.98, 0.52, SOFT, "body", -0.22),
            Row(0.72, 0.9, 0.5, SOFT, "body", -0.2),
        ),
        (
            Row(0.52, 0.36, 0.2, OVAL, "body", 0.36),
            Row(0.72, 0.36, 0.2, OVAL, "body", 0.32),
        ),
        (
            Row(0.72, 0.9, 0.87, SOFT, "body", -0.015),
            Row(0.76, 0.82, 0.78, SOFT, "body", -0.04),
            Row(0.84, 0.6, 0.4, OVAL, "body", -0.14),
            Row(0.84, 0.74, 0.46, ROUND, "cap", -0.14),
            Row(0.98, 0.68, 0.42, ROUND, "cap", -0.14),
            Row(1, 0.6, 0.37, ROUND, "cap", -0.14),
        ),
    ),
    # Squeeze tube that stands on its cap and ends in a flat crimp.
    "tube": (
        (
            *_banded(ROUND, (0, 0.8, "cap"), (0.02, 0.84, "cap"), (0.2, 0.84, "cap"), (0.2, 0.92, "body")),
            Row(0.35, 1, 0.94, ROUND, "label"),
            Row(0.7, 0.55, 0.97, ROUND, "body"),
            Row(0.95, 0.1, 1, SOFT, "body"),
            Row(1, 0.1, 1, SOFT, "body"),
        ),
    ),
    # Tapered cup with a rimmed lid.
    "cup": (
        _banded(
            ROUND,
            (0, 0.76, "body"),
            (0.2, 0.81, "label"),
            (0.7, 0.92, "body"),
            (0.86, 0.96, "cap"),
            (0.87, 1, "cap"),
            (1, 1, "cap"),
        ),
    ),
    # Two tubs of baby food side by side.
    "twin_tub": tuple(
        (
            Row(0, 0.78, 0.4, OVAL, "body", side),
            Row(0.25, 0.83, 0.42, OVAL, "label", side),
            Row(0.7, 0.92, 0.46, OVAL, "body", side),
            Row(0.86, 0.95, 0.48, OVAL, "cap", side),
            Row(0.87, 1, 0.49, OVAL, "cap", side),
            Row(1, 1, 0.49, OVAL, "cap", side),
        )
        for side in (-0.255, 0.255)
    ),
}
"""Profiles by the name of their shape family."""
