"""New scenes: which object, where on the table, and what everything random in them starts from."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from preshape.data.scene import Scene
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from sim.objects.object_model import ObjectSet
from sim.physics import PhysicsSettings
from sim.settling import PlacementSettings, place_object
from sim.table import TableSettings

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class SceneMaker:
    """Makes scenes, each from (run seed, scene id) alone.

    Args:
        objects: what may lie on the table.
        table, physics, placement: how it comes to rest there.
        camera: the camera that looks at it.
        attempts: how many placements are tried until one comes to rest.
        only: names of the objects that are used; None for all.

    Raises:
        InputError: if the set lacks one of those names.
    """

    objects: ObjectSet
    table: TableSettings
    physics: PhysicsSettings
    placement: PlacementSettings
    camera: Camera
    attempts: int = 5
    only: Sequence[str] | None = None

    def __post_init__(self) -> None:
        unknown = sorted(set(self.only or ()) - set(self.objects.names))
        if unknown:
            raise InputError(
                f"{self.objects.name} has no {', '.join(unknown)}",
                where="laboratory.scenes.only",
                fix=f"name some of {', '.join(self.objects.names)}",
            )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects that are used, sorted."""
        return self.objects.names if self.only is None else tuple(sorted(self.only))

    def make(self, run_seed: int, scene_id: int) -> Scene | None:
        """The scene of that number; None if its object would not come to rest on the table."""
        name = self.object_of(run_seed, scene_id)
        rng = np.random.default_rng([run_seed, scene_id])
        model = self.objects.load(name)
        for _ in range(self.attempts):
            pose = place_object(model, self.table, self.physics, self.placement, rng)
            if pose is not None:
                seed = int(rng.integers(2**63))
                return Scene(scene_id, name, pose, self.camera, seed)
        log.warning("Scene %d: %s does not come to rest on the table; the scene is left out.", scene_id, name)
        return None

    def object_of(self, run_seed: int, scene_id: int) -> str:
        """Name of the scene's object: a new random order of the objects in every round through them."""
        names = self.names
        rounds, place = divmod(scene_id, len(names))
        order = np.random.default_rng([run_seed, rounds, len(names), 0]).permutation(len(names))
        return names[order[place]]
