"""Wrappers, bags, tubes and odd things: shape families as data, in fractions of a package's size."""

from collections.abc import Mapping

from sim.objects.package_shapes import OVAL, PILLOW, ROUND, SOFT, Lying, PackageShape, Row, Standing, banded

WRAPPERS: Mapping[str, PackageShape] = {
    # Flow wrapper with crimped ends around a bar.
    "bar": Lying(
        (
            tuple(
                Row(y, width, height, SOFT, material)
                for y, width, height, material in (
                    (0, 1, 0.1, "collar"),
                    (0.085, 1, 0.1, "collar"),
                    (0.085, 0.9, 0.12, "body"),
                    (0.15, 0.9, 1, "label"),
                    (0.85, 0.9, 1, "body"),
                    (0.915, 0.9, 0.12, "collar"),
                    (0.915, 1, 0.1, "collar"),
                    (1, 1, 0.1, "collar"),
                )
            ),
        )
    ),
    # Little flat bag with sealed ends.
    "pouch": Lying(
        (
            tuple(
                Row(y, width, height, PILLOW, material)
                for y, width, height, material in (
                    (0, 0.97, 0.08, "collar"),
                    (0.08, 0.97, 0.08, "body"),
                    (0.27, 1, 1, "label"),
                    (0.73, 1, 1, "body"),
                    (0.92, 0.97, 0.08, "collar"),
                    (1, 0.97, 0.08, "collar"),
                )
            ),
        )
    ),
    # Plump bag, as rice has; its sealed ends sag.
    "bag": Lying(
        (
            tuple(
                Row(y, width, height, SOFT, material, sag)
                for y, width, height, material, sag in (
                    (0, 0.88, 0.05, "collar", -0.2),
                    (0.06, 0.9, 0.06, "body", -0.2),
                    (0.2, 1, 1, "label", 0),
                    (0.8, 1, 1, "body", 0),
                    (0.94, 0.9, 0.06, "collar", -0.2),
                    (1, 0.88, 0.05, "collar", -0.2),
                )
            ),
        )
    ),
    # Bag that stands on a pleated floor and is sealed at the top.
    "standing_pouch": Standing(
        (
            (
                Row(0, 0.88, 0.88, OVAL, "body"),
                Row(0.05, 0.98, 0.97, OVAL, "body"),
                Row(0.2, 1, 1, OVAL, "label"),
                Row(0.64, 0.6, 1, SOFT, "body"),
                Row(0.88, 0.1, 1, SOFT, "collar"),
                Row(1, 0.05, 1, SOFT, "collar"),
            ),
        )
    ),
    # Squeeze tube that stands on its cap and ends in a flat crimp.
    "tube": Standing(
        (
            (
                *banded(ROUND, (0, 0.8, "cap"), (0.02, 0.84, "cap"), (0.2, 0.84, "cap"), (0.2, 0.92, "body")),
                Row(0.35, 1, 0.94, ROUND, "label"),
                Row(0.7, 0.55, 0.97, ROUND, "body"),
                Row(0.95, 0.1, 1, SOFT, "body"),
                Row(1, 0.1, 1, SOFT, "body"),
            ),
        )
    ),
    # The same, lying: from the cap towards -y to a flat crimp, all resting on the table.
    "lying_tube": Lying(
        (
            (
                Row(0, 0.62, 0.84, ROUND, "cap", -0.08),
                Row(0.13, 0.64, 0.86, ROUND, "cap", -0.07),
                Row(0.14, 0.72, 0.98, ROUND, "body", -0.01),
                Row(0.2, 0.76, 1, OVAL, "label"),
                Row(0.55, 0.9, 0.7, OVAL, "label", -0.15),
                Row(0.85, 0.98, 0.28, OVAL, "body", -0.36),
                Row(0.95, 1, 0.08, SOFT, "collar", -0.46),
                Row(1, 1, 0.08, SOFT, "collar", -0.46),
            ),
        )
    ),
    "marker": Lying(
        (
            (
                Row(0, 0.84, 0.84, ROUND, "cap", -0.08),
                Row(0.03, 1, 1, ROUND, "cap"),
                Row(0.4, 1, 1, ROUND, "cap"),
                Row(0.4, 0.9, 0.9, ROUND, "label", -0.05),
                Row(0.96, 0.9, 0.9, ROUND, "cap", -0.05),
                Row(1, 0.74, 0.74, ROUND, "cap", -0.13),
            ),
        )
    ),
    # Tapered table leg with a metal plate at its thick end.
    "leg": Lying(
        (
            (
                Row(0, 1, 1, SOFT, "cap"),
                Row(0.015, 1, 1, SOFT, "body"),
                Row(1, 0.58, 0.58, SOFT, "body", -0.21),
            ),
        )
    ),
    # A toy animal that sits: body, head, two arms, two ears.
    "figure": Standing(
        (
            (
                Row(0, 0.84, 0.58, OVAL, "body"),
                Row(0.06, 0.98, 0.7, OVAL, "body"),
                Row(0.24, 1, 0.72, OVAL, "body"),
                Row(0.5, 0.6, 0.46, OVAL, "body"),
            ),
            (
                Row(0.5, 0.58, 0.44, ROUND, "cap"),
                Row(0.6, 0.92, 0.74, ROUND, "cap"),
                Row(0.7, 1, 0.84, ROUND, "cap"),
                Row(0.82, 0.9, 0.72, ROUND, "cap"),
                Row(0.92, 0.5, 0.4, ROUND, "cap"),
            ),
            *(
                (
                    Row(0.84, 0.24, 0.2, ROUND, "label", 0.26 * side),
                    Row(0.94, 0.3, 0.24, ROUND, "label", 0.33 * side),
                    Row(1, 0.16, 0.14, ROUND, "label", 0.34 * side),
                )
                for side in (-1, 1)
            ),
            *(
                (
                    Row(0.14, 0.26, 0.16, ROUND, "label", 0.4 * side),
                    Row(0.24, 0.34, 0.2, ROUND, "label", 0.4 * side),
                    Row(0.42, 0.26, 0.16, ROUND, "label", 0.33 * side),
                )
                for side in (-1, 1)
            ),
        )
    ),
}
