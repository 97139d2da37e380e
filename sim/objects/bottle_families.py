"""Bottles: shape families as data, in fractions of a package's size."""

from collections.abc import Mapping

from sim.objects.package_shapes import OVAL, ROUND, SOFT, PackageShape, Row, Standing, banded, round_rows

BOTTLES: Mapping[str, PackageShape] = {
    # Broad oval body, short neck, round screw cap.
    "oval_bottle": Standing(
        (
            (
                *banded(
                    OVAL,
                    (0, 0.93, "body"),
                    (0.03, 1, "body"),
                    (0.12, 1, "label"),
                    (0.6, 1, "body"),
                    (0.7, 0.97, "body"),
                ),
                *round_rows((0.82, 0.62, "body"), (0.84, 0.6, "cap"), (0.98, 0.58, "cap"), (1, 0.5, "cap")),
            ),
        )
    ),
    # Flat-shouldered bottle with a broad flip-top cap, as shampoo has.
    "flip_top_bottle": Standing(
        (
            (
                *banded(
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
        )
    ),
    # Slim bottle with a long neck, as hot sauce has.
    "sauce_bottle": Standing(
        (
            round_rows(
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
        )
    ),
    # Waisted bottle with a tall cap, as syrup and creamer have.
    "waisted_bottle": Standing(
        (
            (
                *banded(
                    OVAL,
                    (0, 0.94, "body"),
                    (0.03, 1, "body"),
                    (0.1, 1, "label"),
                    (0.4, 0.97, "body"),
                    (0.52, 0.84, "body"),
                    (0.64, 0.9, "body"),
                    (0.72, 0.86, "body"),
                ),
                *round_rows((0.85, 0.56, "body"), (0.86, 0.56, "cap"), (0.98, 0.52, "cap"), (1, 0.44, "cap")),
            ),
        )
    ),
    # Waisted glass bottle with a crown cap.
    "contour_bottle": Standing(
        (
            round_rows(
                (0, 0.9, "body"),
                (0.03, 0.98, "body"),
                (0.1, 1, "body"),
                (0.28, 0.87, "label"),
                (0.45, 0.98, "body"),
                (0.57, 0.97, "body"),
                (0.74, 0.6, "body"),
                (0.93, 0.42, "body"),
                (0.95, 0.46, "cap"),
                (0.985, 0.48, "cap"),
                (1, 0.42, "cap"),
            ),
        )
    ),
    # Square bottle with a round neck.
    "square_bottle": Standing(
        (
            (
                *banded(
                    SOFT,
                    (0, 0.93, "body"),
                    (0.03, 1, "body"),
                    (0.1, 1, "label"),
                    (0.56, 1, "body"),
                    (0.66, 0.96, "body"),
                ),
                *round_rows((0.84, 0.44, "body"), (0.86, 0.54, "cap"), (0.98, 0.53, "cap"), (1, 0.48, "cap")),
            ),
        )
    ),
    # Oval bottle that narrows to a push-pull cap, as dish soap has.
    "dish_bottle": Standing(
        (
            (
                *banded(
                    OVAL,
                    (0, 0.92, "body"),
                    (0.03, 1, "body"),
                    (0.1, 1, "label"),
                    (0.52, 1, "body"),
                    (0.66, 0.82, "body"),
                ),
                *round_rows(
                    (0.8, 0.5, "body"),
                    (0.82, 0.52, "cap"),
                    (0.9, 0.48, "cap"),
                    (0.92, 0.3, "cap"),
                    (1, 0.26, "cap"),
                ),
            ),
        )
    ),
    # Rectangular bottle with sloping shoulders and a big screw cap.
    "mouthwash_bottle": Standing(
        (
            (
                *banded(
                    SOFT,
                    (0, 0.94, "body"),
                    (0.03, 1, "body"),
                    (0.12, 1, "label"),
                    (0.54, 1, "body"),
                    (0.64, 0.94, "body"),
                ),
                *round_rows((0.78, 0.6, "body"), (0.8, 0.68, "cap"), (0.98, 0.66, "cap"), (1, 0.6, "cap")),
            ),
        )
    ),
    # Soap dispenser: oval body, collar, pump head with a spout towards +y.
    "pump_bottle": Standing(
        (
            (
                *banded(
                    OVAL,
                    (0, 0.95, "body"),
                    (0.03, 1, "body"),
                    (0.12, 1, "label"),
                    (0.52, 1, "body"),
                    (0.62, 0.92, "body"),
                ),
                *round_rows((0.7, 0.62, "cap"), (0.8, 0.58, "cap"), (0.81, 0.24, "cap"), (0.9, 0.24, "cap")),
            ),
            (
                Row(0.9, 0.5, 0.48, SOFT, "cap", 0.1),
                Row(0.97, 0.5, 0.5, SOFT, "cap", 0.11),
                Row(1, 0.4, 0.42, SOFT, "cap", 0.11),
            ),
        )
    ),
    # Spray bottle: oval body, neck, a head with its nozzle towards +y, and a trigger below it.
    "trigger_bottle": Standing(
        (
            (
                Row(0, 0.93, 0.8, OVAL, "body", -0.07),
                Row(0.03, 1, 0.86, OVAL, "body", -0.07),
                Row(0.1, 1, 0.86, OVAL, "label", -0.07),
                Row(0.44, 1, 0.86, OVAL, "body", -0.07),
                Row(0.58, 0.8, 0.58, OVAL, "body", -0.07),
                Row(0.7, 0.48, 0.27, ROUND, "cap", -0.07),
                Row(0.72, 0.56, 0.31, ROUND, "cap", -0.07),
                Row(0.81, 0.54, 0.3, ROUND, "cap", -0.07),
            ),
            (
                Row(0.81, 0.46, 0.36, SOFT, "cap", -0.06),
                Row(0.9, 0.5, 0.72, SOFT, "cap", 0.1),
                Row(0.97, 0.5, 0.8, SOFT, "cap", 0.1),
                Row(1, 0.36, 0.66, SOFT, "cap", 0.06),
            ),
            (Row(0.68, 0.22, 0.09, SOFT, "cap", 0.4), Row(0.88, 0.26, 0.14, SOFT, "cap", 0.3)),
        )
    ),
    # Jug: broad foot, a column that carries the neck, and a handle beside it, open between the two.
    "jug": Standing(
        (
            (
                *banded(
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
        )
    ),
}
