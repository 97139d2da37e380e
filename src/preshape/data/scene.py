"""A scene: one object at rest on the table before one camera. Everything that an image is a function of."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation


@dataclass(frozen=True, eq=False)
class Scene:
    """One object at rest on the table.

    Args:
        scene_id: number of the scene in its table.
        object_id: name of the object in its object set.
        T_world_object: settled pose of the object.
        camera: the camera that looks at it.
        seed: seed of everything random in the scene (placement, sensor noise).
    """

    scene_id: int
    object_id: str
    T_world_object: Float[np.ndarray, "4 4"]
    camera: Camera
    seed: int


@runtime_checkable
class SceneRenderer(Protocol):
    """Makes the image of a scene; a pure function of the scene."""

    @property
    def fingerprint(self) -> str:
        """Text that is the same for two renderers only if they make the same images."""

    def __call__(self, scene: Scene) -> Observation: ...
