"""The objects of a set, and each of them in other proportions."""

import hashlib
import math
import re
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from preshape.errors import InputError
from sim.objects.object_model import ObjectModel, ObjectSet

STRETCHED = re.compile(r"(?P<original>.+)_stretched_(?P<copy>[1-9]\d*)")
SQUARE = 0.05
"""Widths along x and y that differ by less than this share keep their ratio: what is round stays round."""


@dataclass(frozen=True)
class StretchedObjects:
    """An `ObjectSet` with copies of each object that are stretched along its axes, by factors of their own.

    Density and friction stay, so that a copy of twice the volume weighs twice as much.

    Args:
        objects: the set; it is part of this one.
        copies: number of copies of each of its objects, called `<name>_stretched_1` and so on.
        most: the largest factor along an axis; the smallest is its inverse, and all between are equally
            probable on a logarithmic scale.
        seed: what the factors follow from, together with a copy's name.
    """

    objects: ObjectSet
    copies: int
    most: float
    seed: int = 0

    def __post_init__(self) -> None:
        if self.copies < 0:
            raise InputError("Less than no copies", where=f"copies={self.copies}", fix="give 0 or more")
        if not (math.isfinite(self.most) and self.most >= 1):
            raise InputError("Not a largest factor", where=f"most={self.most}", fix="give 1 or more")

    @property
    def name(self) -> str:
        """Name of the set."""
        return self.objects.name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the originals and of their copies, sorted."""
        originals = self.objects.names
        copies = (f"{name}_stretched_{k + 1}" for name in originals for k in range(self.copies))
        return tuple(sorted((*originals, *copies)))

    @property
    def fingerprint(self) -> str:
        """Hash of the set and of what the copies follow from."""
        own = (self.objects.fingerprint, self.copies, self.most, self.seed)
        return hashlib.sha256(repr(own).encode()).hexdigest()

    def load(self, name: str) -> ObjectModel:
        """The model of an object; raises `InputError` for a name that the set does not hold."""
        copy = STRETCHED.fullmatch(name)
        if copy is None or name in self.objects.names or int(copy["copy"]) > self.copies:
            return self.objects.load(name)
        original = self.objects.load(copy["original"])
        return replace(_stretched(original, self._factors(name, original)), object_id=name)

    def _factors(self, name: str, original: ObjectModel) -> Float[np.ndarray, "3"]:
        own = int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big")
        rng = np.random.default_rng([self.seed, own])
        factors = np.exp(rng.uniform(-1, 1, 3) * math.log(self.most))
        width, depth, _ = original.size
        if abs(width - depth) < SQUARE * max(width, depth):
            factors[1] = factors[0]
        return np.asarray(factors)


def original_of(name: str) -> str:
    """Name of the object that a stretched one is a copy of; of any other, its own."""
    copy = STRETCHED.fullmatch(name)
    return name if copy is None else copy["original"]


def _stretched(model: ObjectModel, factors: Float[np.ndarray, "3"]) -> ObjectModel:
    """An object stretched along its axes. The centre of mass stays the origin."""
    own = factors.astype(np.float32)
    visuals = []
    for part in model.visual_parts:
        normals = part.normals / own
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        visuals.append(replace(part, vertices=part.vertices * own, normals=normals / lengths))
    return replace(
        model,
        collision_parts=tuple(part * factors for part in model.collision_parts),
        visual_parts=tuple(visuals),
        mass_kg=model.mass_kg * float(factors.prod()),
    )
