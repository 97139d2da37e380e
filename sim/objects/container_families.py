"""Boxes, cans, cups and plates: shape families as data, in fractions of a package's size."""

from collections.abc import Mapping

from sim.objects.package_shapes import BOX, OVAL, ROUND, SOFT, PackageShape, Row, Standing, banded, round_rows
from sim.objects.vessel import Vessel

CONTAINERS: Mapping[str, PackageShape] = {
    "box": Standing((banded(BOX, (0, 1, "body"), (1, 1, "body")),)),
    # A flat carton or bar of chocolate on its broad side.
    "slab": Standing((banded(BOX, (0, 1, "body"), (1, 1, "body")),)),
    # A tin: rims of bare metal around a paper label.
    "can": Standing(
        (
            banded(
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
        )
    ),
    # A tin with rounded rectangular walls.
    "flat_can": Standing(
        (
            banded(
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
        )
    ),
    "drink_can": Standing(
        (
            banded(
                ROUND,
                (0, 0.78, "rim"),
                (0.07, 1, "body"),
                (0.3, 1, "label"),
                (0.68, 1, "body"),
                (0.9, 1, "rim"),
                (0.97, 0.84, "rim"),
                (1, 0.84, "rim"),
            ),
        )
    ),
    # A cardboard tube with a metal foot and a plastic lid.
    "snack_can": Standing(
        (
            banded(
                ROUND,
                (0, 0.97, "rim"),
                (0.02, 0.97, "body"),
                (0.25, 0.97, "label"),
                (0.7, 0.97, "body"),
                (0.965, 1, "cap"),
                (1, 1, "cap"),
            ),
        )
    ),
    "spray_can": Standing(
        (
            round_rows(
                (0, 0.97, "rim"),
                (0.015, 1, "body"),
                (0.2, 1, "label"),
                (0.6, 1, "body"),
                (0.72, 1, "rim"),
                (0.76, 0.84, "cap"),
                (0.97, 0.78, "cap"),
                (1, 0.7, "cap"),
            ),
        )
    ),
    # A tin with a broad plastic lid, as cocoa has.
    "canister": Standing(
        (
            banded(
                SOFT,
                (0, 0.95, "body"),
                (0.02, 0.97, "body"),
                (0.2, 0.97, "label"),
                (0.7, 0.97, "body"),
                (0.9, 1, "cap"),
                (0.985, 1, "cap"),
                (1, 0.96, "cap"),
            ),
        )
    ),
    # Tapered cup with a rimmed lid.
    "cup": Standing(
        (
            banded(
                ROUND,
                (0, 0.76, "body"),
                (0.2, 0.81, "label"),
                (0.7, 0.92, "body"),
                (0.86, 0.96, "cap"),
                (0.87, 1, "cap"),
                (1, 1, "cap"),
            ),
        )
    ),
    # Foam cup under a lid of foil.
    "noodle_cup": Standing(
        (
            banded(
                ROUND,
                (0, 0.74, "body"),
                (0.2, 0.79, "label"),
                (0.72, 0.93, "body"),
                (0.95, 0.975, "cap"),
                (0.96, 1, "cap"),
                (1, 1, "cap"),
            ),
        )
    ),
    # Waisted cup to sip from.
    "soup_cup": Standing(
        (
            banded(
                ROUND,
                (0, 0.86, "body"),
                (0.04, 0.9, "body"),
                (0.1, 0.88, "label"),
                (0.45, 0.8, "label"),
                (0.72, 0.94, "body"),
                (0.78, 0.96, "cap"),
                (0.8, 1, "cap"),
                (0.94, 0.98, "cap"),
                (1, 0.84, "cap"),
            ),
        )
    ),
    # Two tubs of baby food side by side.
    "twin_tub": Standing(
        tuple(
            (
                Row(0, 0.78, 0.4, OVAL, "body", side),
                Row(0.25, 0.83, 0.42, OVAL, "label", side),
                Row(0.7, 0.92, 0.46, OVAL, "body", side),
                Row(0.86, 0.95, 0.48, OVAL, "cap", side),
                Row(0.87, 1, 0.49, OVAL, "cap", side),
                Row(1, 1, 0.49, OVAL, "cap", side),
            )
            for side in (-0.255, 0.255)
        )
    ),
    "open_cup": Vessel(foot=0.66, wall=0.02, floor=0.025),
    "sleeve": Vessel(foot=0.84, wall=0.022, floor=0.0),
    "plate": Vessel(foot=0.64, wall=0.022, floor=0.14),
}
