"""The objects of a set, heavier or lighter than they are."""

import hashlib
from dataclasses import dataclass, replace

from sim.objects.object_model import ObjectModel, ObjectSet


@dataclass(frozen=True)
class ReweighedObjects:
    """An `ObjectSet` whose objects have another density.

    Args:
        objects: the set.
        factor: what every mass is multiplied with.
    """

    objects: ObjectSet
    factor: float

    @property
    def name(self) -> str:
        """Name of the set."""
        return self.objects.name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its objects, sorted."""
        return self.objects.names

    @property
    def fingerprint(self) -> str:
        """Hash of the set and the factor."""
        return hashlib.sha256(f"{self.objects.fingerprint} {self.factor!r}".encode()).hexdigest()

    def load(self, name: str) -> ObjectModel:
        """The model of one object; raises `InputError` for a name that the set does not hold."""
        model = self.objects.load(name)
        return replace(model, mass_kg=model.mass_kg * self.factor)
