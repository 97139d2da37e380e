"""The generated grocery set: BigBIRD's names and proportions as shape families in distinguishable colours."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from preshape.errors import InputError
from sim.objects import colour, loft, object_model, package_profiles, package_shapes, shading
from sim.objects.colour import colour_from_hex
from sim.objects.loft import convex_parts, visual_parts
from sim.objects.object_model import PAPER_FRICTION, ObjectModel, volume_and_centroid
from sim.objects.package_profiles import PROFILES
from sim.objects.package_shapes import lofts


@dataclass(frozen=True)
class GroceryItem:
    """One row of the grocery table.

    Args:
        family: key of `package_profiles.PROFILES`.
        size_mm: along x, y and z, standing on the predetermined support surface.
        colours: sRGB "#rrggbb" of each material of the family.
    """

    family: str
    size_mm: tuple[float, float, float]
    colours: Mapping[str, str]


def _item(family: str, size_mm: tuple[float, float, float], **colours: str) -> GroceryItem:
    return GroceryItem(family, size_mm, colours)


# Mass of a full package over its outer volume (kg/m3): liquids nearly fill it, dry goods leave much air.
FAMILY_DENSITIES: Mapping[str, float] = {
    "box": 250.0,
    "can": 1000.0,
    "flat_can": 900.0,
    "drink_can": 1000.0,
    "snack_can": 180.0,
    "spray_can": 600.0,
    "oval_bottle": 950.0,
    "flip_top_bottle": 950.0,
    "sauce_bottle": 950.0,
    "waisted_bottle": 950.0,
    "pump_bottle": 900.0,
    "jug": 950.0,
    "tube": 900.0,
    "cup": 700.0,
    "twin_tub": 800.0,
}
METAL = "#b9bcc2"
# Sizes from scans where they are known (boxes +-5 %, bottles +-15 %), else of the item as sold.
GROCERY_ITEMS: Mapping[str, GroceryItem] = {
    "3m_high_tack_spray_adhesive": _item(
        "spray_can", (78, 78, 222), body="#e8e6df", label="#c8102e", rim=METAL, cap="#1d1d1f"
    ),
    "aunt_jemima_original_syrup": _item(
        "waisted_bottle", (62, 90, 222), body="#5a2a12", label="#d7282f", cap="#f2c230"
    ),
    "canon_ack_e10_box": _item("box", (68, 115, 152), body="#e9e9ea", label="#b01020"),
    "cheez_it_white_cheddar": _item("box", (55, 156, 189), body="#f4f0e6", label="#d9261c"),
    "cholula_chipotle_hot_sauce": _item(
        "sauce_bottle", (41, 41, 161), body="#8c2f12", label="#f3d36b", collar="#8c2f12", cap="#a9743c"
    ),
    "coffee_mate_french_vanilla": _item(
        "waisted_bottle", (72, 88, 215), body="#f1dfb1", label="#1f4fa3", cap="#c41e2a"
    ),
    "crayola_24_crayons": _item("box", (36, 76, 96), body="#f7c600", label="#1a7a3c"),
    "detergent": _item("jug", (77, 126, 237), body="#e8650e", label="#1b3f94", cap="#1d5bbf"),
    "mom_to_mom_butternut_squash_pear": _item(
        "twin_tub", (62, 124, 58), body="#e39a35", label="#7fae3a", cap="#f2efe4"
    ),
    "pepto_bismol": _item("oval_bottle", (50, 52, 144), body="#ef6fa7", label="#f9d94a", cap="#e8418c"),
    "pringles_bbq": _item(
        "snack_can", (76, 76, 246), body="#7a1f1a", label="#e0932b", rim=METAL, cap="#e9e4d8"
    ),
    "red_bull": _item("drink_can", (58, 58, 127), body="#1b3fa0", label="#c7cbd4", rim=METAL),
    "softsoap_white": _item("pump_bottle", (32, 61, 123), body="#f3f3f0", label="#56b3a5", cap="#fafafa"),
    "spam": _item("flat_can", (56, 96, 76), body="#1c3f94", label="#f5c518", rim=METAL),
    "suave_sweet_guava_nectar_body_wash": _item(
        "flip_top_bottle", (40, 63, 205), body="#f28a80", label="#f7d9c4", cap="#fbfbf8"
    ),
    "v8_fusion_peach_mango": _item("can", (70, 70, 111), body="#f29a2e", label="#2f8f3d", rim=METAL),
    "vo5_extra_body_volumizing_shampoo": _item(
        "flip_top_bottle", (44, 70, 214), body="#4fb0d9", label="#f2f2f2", cap="#27488f"
    ),
}


@dataclass(frozen=True)
class GrocerySet:
    """The grocery objects as an `ObjectSet`.

    Args:
        density: kg/m3, of every object; None weighs each as a full package of its family.
        friction: Coulomb coefficient.
    """

    density: float | None = None
    friction: float = PAPER_FRICTION
    name: str = "grocery"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects, sorted."""
        return tuple(sorted(GROCERY_ITEMS))

    @property
    def fingerprint(self) -> str:
        """Hash of the table, the shapes and the code that makes solids of them."""
        digest = hashlib.sha256(repr((self.density, self.friction)).encode())
        for module in (object_model, colour, shading, loft, package_shapes, package_profiles):
            digest.update(Path(str(module.__file__)).read_bytes())
        digest.update(Path(__file__).read_bytes())
        return digest.hexdigest()

    def load(self, name: str) -> ObjectModel:
        """The model of one object; raises `InputError` for an unknown name."""
        if name not in GROCERY_ITEMS:
            raise InputError(
                f"The grocery set has no object {name!r}",
                where="objects",
                fix=f"choose one of: {', '.join(self.names)}",
            )
        return _build(name, self.density or FAMILY_DENSITIES[GROCERY_ITEMS[name].family], self.friction)


@cache
def _build(name: str, density: float, friction: float) -> ObjectModel:
    item = GROCERY_ITEMS[name]
    colours = {material: colour_from_hex(code) for material, code in item.colours.items()}
    width, depth, height = (length / 1000 for length in item.size_mm)
    pieces = lofts(PROFILES[item.family], (width, depth, height), colours)
    parts = tuple(part for piece in pieces for part in convex_parts(piece))
    visuals = tuple(part for piece in pieces for part in visual_parts(piece))
    mass = density * volume_and_centroid(parts)[0]
    return ObjectModel(name, parts, visuals, mass, friction).centred()
