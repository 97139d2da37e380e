"""The page about a copy of the Cornell data."""

import math
from collections.abc import Mapping
from typing import Any

from analysis.cornell.protocols import protocol_table
from analysis.wording import plain_name, table_row
from preshape.provenance import git_revision, lasting_command

COUNTS = ("images", "objects", "categories", "backgrounds", "positives", "negatives")
COLUMNS = ("images", "objects", "positives", "negatives")


def page(figures: Mapping[str, Any], name: str, pictures: Mapping[str, str]) -> str:
    """Markdown with the figures that `CornellReport` gathers.

    Args:
        figures: the figures.
        name: of the rows about this data among the protocols.
        pictures: captions of the pictures of the protocols, by their files.
    """
    parts = [
        ["# The Cornell grasp data set"],
        [f"Made by `{lasting_command()}` at revision `{git_revision()}`."],
        _counts(figures),
        *(_folds(name, sizes) for name, sizes in figures["folds"].items()),
        _metric(figures["metric"]),
        _surfaces(figures["surfaces"]),
        ["![Images with positive (blue) and negative (orange) rectangles](contact_sheet.png)"],
        ["## Recognition and detection"],
        protocol_table(figures["protocols"], name),
        *([f"![{caption}]({file})"] for file, caption in pictures.items()),
    ]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _counts(figures: Mapping[str, Any]) -> list[str]:
    rows = [table_row(name, figures[name]) for name in COUNTS]
    rows += [table_row(f"dropped: {flaw}", count) for flaw, count in figures["dropped"].items()]
    return [table_row("what", "how many"), "|---|---:|", *rows]


def _folds(name: str, sizes: list[dict[str, int]]) -> list[str]:
    rows = [table_row(fold, *(size[column] for column in COLUMNS)) for fold, size in enumerate(sizes)]
    head = table_row(f"{plain_name(name)} fold".replace(" wise", "-wise"), *COLUMNS)
    return [head, "|---|---:|---:|---:|---:|", *rows]


def _metric(figures: Mapping[str, Mapping[str, float]]) -> list[str]:
    said = (
        f"{own['accepted']} of {own['n']} {name} ({100 * own['rate']:.0f} %, "
        f"95 % Wilson interval {100 * own['low']:.0f} to {100 * own['high']:.0f} %)"
        for name, own in figures.items()
        if own["n"]
    )
    return [
        f"The other positive rectangles of an image make the rectangle metric accept {', and '.join(said)}."
    ]


def _surfaces(figures: Mapping[str, Any]) -> list[str]:
    lines = [
        f"Depth comes from measured points in {figures['measured']} images, and approximately from the range "
        f"image in {figures['approximate']}."
    ]
    lines += [
        f"In {own['images']} images with {surface} depth the table is a plane to "
        f"{1000 * own['plane_m']:.1f} mm, and its normals to {math.degrees(own['normal_rad']):.1f} degrees "
        "(medians)."
        for surface, own in figures["flatness"].items()
    ]
    apart = figures["difference"]
    lines.append(
        "No image has both, so that they cannot be compared."
        if apart is None
        else f"In {apart['images']} images that have both, the approximate depth is "
        f"{1000 * apart['depth_m']:.1f} mm and the normals are {math.degrees(apart['normal_rad']):.1f} "
        "degrees off (medians)."
    )
    return lines
