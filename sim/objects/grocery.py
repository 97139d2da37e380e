"""The generated grocery set: BigBIRD's 125 names as shape families of true proportions."""

import csv
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from preshape.errors import InputError
from sim.objects.bottle_families import BOTTLES
from sim.objects.container_families import CONTAINERS
from sim.objects.looks.dressing import dressed
from sim.objects.looks.look import Look, read_looks
from sim.objects.object_model import PAPER_FRICTION, ObjectModel, volume_and_centroid
from sim.objects.package_shapes import PackageShape
from sim.objects.wrapper_families import WRAPPERS

TABLE = Path(__file__).with_name("grocery_items.csv")
FAMILIES: Mapping[str, PackageShape] = {**CONTAINERS, **BOTTLES, **WRAPPERS}


@dataclass(frozen=True)
class GroceryItem:
    """One row of the grocery table.

    Args:
        family: key of `FAMILIES`.
        size_mm: along x, y and z, resting on the predetermined support surface: from scans where they are
            known (boxes +-5 %, bottles +-15 %), else of the item as sold.
        mass_g: of the full package.
    """

    family: str
    size_mm: tuple[float, float, float]
    mass_g: float


def _read_items() -> Mapping[str, GroceryItem]:
    with TABLE.open(newline="") as file:
        return {
            row["name"]: GroceryItem(
                row["family"],
                (float(row["x_mm"]), float(row["y_mm"]), float(row["z_mm"])),
                float(row["mass_g"]),
            )
            for row in csv.DictReader(file)
        }


GROCERY_ITEMS: Mapping[str, GroceryItem] = _read_items()
"""The table grocery_items.csv by name."""
GROCERY_LOOKS: Mapping[str, Look] = read_looks()


@dataclass(frozen=True)
class GrocerySet:
    """The grocery objects as an `ObjectSet`.

    Args:
        density: kg/m3, of every object; None weighs each as the full package.
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
        """Hash of the tables, the shapes and the code that makes objects of them."""
        digest = hashlib.sha256(repr((self.density, self.friction)).encode())
        for path in sorted(Path(__file__).parent.rglob("*")):
            if path.suffix in (".py", ".csv"):
                digest.update(path.read_bytes())
        return digest.hexdigest()

    def load(self, name: str) -> ObjectModel:
        """The model of one object; raises `InputError` for an unknown name."""
        if name not in GROCERY_ITEMS:
            raise InputError(
                f"The grocery set has no object {name!r}",
                where="objects",
                fix=f"choose one of: {', '.join(self.names)}",
            )
        return _build(name, self.density, self.friction)


@cache
def _build(name: str, density: float | None, friction: float) -> ObjectModel:
    item = GROCERY_ITEMS[name]
    width, depth, height = (length / 1000 for length in item.size_mm)
    solid = FAMILIES[item.family].solid((width, depth, height))
    visuals = dressed(solid, (width, depth, height), item.family, GROCERY_LOOKS[name])
    mass = item.mass_g / 1000 if density is None else density * volume_and_centroid(solid.parts)[0]
    return ObjectModel(name, solid.parts, visuals, mass, friction).centred()
