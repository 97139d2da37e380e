"""From bare walls to what the camera sees."""

from collections.abc import Mapping

import numpy as np

from sim.objects.colour import colour_from_hex
from sim.objects.looks.artwork import artwork
from sim.objects.looks.look import Look
from sim.objects.looks.unfolding import Triangles, Unfolding, carton, flat, panels, peeled
from sim.objects.object_model import VisualPart
from sim.objects.package_shapes import Size, Solid
from sim.objects.shading import shaded_part, textured_part

LYING = {
    **dict.fromkeys(("bar", "pouch", "bag", "lying_tube", "marker"), ("front", "paper")),
    "slab": ("front", "brand"),
    "plate": ("rings", "paper"),
}
"""Families that are printed on top, and what is there and on their long sides."""
BROAD_SIDES = {"jug": 1, "tube": 1, "standing_pouch": 1, "twin_tub": 2}
"""Families that are printed on their broad sides, so many times side by side."""
PRINTED_BODY = {"box", "slab", "plate", "sleeve"}
"""Families that have no label: the print is on their body."""

TALL_LABELS: Mapping[str, tuple[float, float]] = {
    "can": (0.13, 0.87),
    "flat_can": (0.18, 0.84),
    "drink_can": (0.12, 0.84),
    "snack_can": (0.1, 0.86),
    "spray_can": (0.08, 0.68),
    "twin_tub": (0.12, 0.84),
    "cup": (0.08, 0.84),
    "noodle_cup": (0.1, 0.9),
    "soup_cup": (0.06, 0.74),
    "sleeve": (0.05, 0.95),
    "oval_bottle": (0.08, 0.66),
    "flip_top_bottle": (0.1, 0.72),
    "waisted_bottle": (0.06, 0.44),
    "pump_bottle": (0.08, 0.58),
    "standing_pouch": (0.1, 0.86),
    "tube": (0.26, 0.88),
    "jug": (0.06, 0.48),
}
"""Families whose print reaches beyond the wall that is their label: from and to which share of the height."""


def dressed(solid: Solid, size: Size, family: str, look: Look) -> tuple[VisualPart, ...]:
    """The parts that are seen: one with everything that is printed, one for each other material."""
    walls = dict(solid.walls)
    parts = []
    if look.style:
        printed = [walls.pop(material) for material in _printed(family) if material in walls]
        ground, field = ("body", "label") if family in PRINTED_BODY else ("label", "body")
        unfolding = _unfolded(np.concatenate(printed), size, family, solid.walls[ground])
        texture = artwork(look, unfolding.size, unfolding.prints, ground, field)
        parts.append(textured_part(np.concatenate(printed), unfolding.uvs, texture))
    parts += [
        shaded_part(triangles, colour_from_hex(look.colours[material]))
        for material, triangles in walls.items()
    ]
    return tuple(parts)


def _printed(family: str) -> tuple[str, ...]:
    if family == "sleeve":
        return ("body",)
    return ("body", "label")


def _unfolded(triangles: Triangles, size: Size, family: str, label: Triangles) -> Unfolding:
    if family == "box":
        return carton(triangles, size)
    if family in LYING:
        return flat(triangles, size, label, *LYING[family])
    low, high = TALL_LABELS.get(family, (0.0, 0.0))
    heights = (
        (low * size[2], high * size[2]) if high else (float(label[..., 2].min()), float(label[..., 2].max()))
    )
    if family in BROAD_SIDES:
        return panels(triangles, size, heights, BROAD_SIDES[family])
    return peeled(triangles, size, label, heights)
