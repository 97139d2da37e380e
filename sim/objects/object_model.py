"""One rigid object: what it collides as, what it looks like, and how heavy it is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, Self

import numpy as np
from jaxtyping import Float, Float32, UInt8, UInt32
from scipy.spatial import ConvexHull

from preshape.geometry.pose import transform_points
from sim.objects.colour import LinearColour

PAPER_DENSITY = 100.0
"""Density of every object in the authors' simulation (kg/m3)."""
PAPER_FRICTION = 1.0


@dataclass(frozen=True, eq=False)
class VisualPart:
    """A triangle mesh of one material, in the object's frame.

    Args:
        vertices, normals: m, and unit length.
        faces: indices of the vertices, counter-clockwise from outside.
        colour: linear RGB, 0-1, where there is no texture.
        uvs: texture coordinates, v pointing up.
        texture: sRGB image.
    """

    vertices: Float32[np.ndarray, "v 3"]
    faces: UInt32[np.ndarray, "f 3"]
    normals: Float32[np.ndarray, "v 3"]
    colour: LinearColour
    uvs: Float32[np.ndarray, "v 2"] | None = None
    texture: UInt8[np.ndarray, "h w 3"] | None = None


@dataclass(frozen=True, eq=False)
class ObjectModel:
    """A rigid object of uniform density.

    The object's frame has its origin at the centre of mass, so that the height of the origin is what a lift
    raises, however the object turns in the hand. In the identity rotation z points up and the object stands
    on its predetermined support surface (paper, section 4.1), which lies at z = -`standing_height_m`.

    Args:
        object_id: name in its object set.
        collision_parts: vertices (m) of convex parts; each part is the convex hull of its vertices.
        visual_parts: what the camera sees.
        mass_kg: mass of the whole object.
        friction: Coulomb coefficient, static and dynamic.
    """

    object_id: str
    collision_parts: tuple[Float[np.ndarray, "_ 3"], ...]
    visual_parts: tuple[VisualPart, ...]
    mass_kg: float
    friction: float

    @property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner (m) of the collision geometry in the object's frame."""
        vertices = np.concatenate(self.collision_parts)
        return np.stack((vertices.min(axis=0), vertices.max(axis=0)))

    @property
    def size(self) -> Float[np.ndarray, "3"]:
        """Width along x, y and z (m)."""
        return self.bounds[1] - self.bounds[0]

    @property
    def standing_height_m(self) -> float:
        """Height of the origin over a table on which the object stands."""
        return float(-self.bounds[0, 2])

    @cached_property
    def volume_m3(self) -> float:
        """Volume of the convex parts; parts that overlap count twice, as they do in the simulator."""
        return volume_and_centroid(self.collision_parts)[0]

    @property
    def density(self) -> float:
        """Density (kg/m3) that gives the convex parts the object's mass."""
        return self.mass_kg / self.volume_m3

    def moved(self, pose: Float[np.ndarray, "4 4"]) -> Self:
        """The same object with all its geometry moved by `pose`."""
        parts = tuple(transform_points(pose, part) for part in self.collision_parts)
        rotation, position = pose[:3, :3].astype(np.float32), pose[:3, 3].astype(np.float32)
        visuals = tuple(
            replace(part, vertices=part.vertices @ rotation.T + position, normals=part.normals @ rotation.T)
            for part in self.visual_parts
        )
        return replace(self, collision_parts=parts, visual_parts=visuals)

    def centred(self) -> Self:
        """The same object with its origin moved to the centre of mass."""
        pose = np.eye(4)
        pose[:3, 3] = -volume_and_centroid(self.collision_parts)[1]
        return self.moved(pose)


class ObjectSet(Protocol):
    """Named objects that a scene can hold."""

    @property
    def name(self) -> str:
        """Name of the set, as in the trial tables."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its objects, sorted."""
        ...

    @property
    def fingerprint(self) -> str:
        """Hash of everything that the models depend on: equal fingerprints, equal models."""
        ...

    def load(self, name: str) -> ObjectModel:
        """The model of one object; raises `InputError` for a name that the set does not hold."""
        ...


def volume_and_centroid(
    parts: Sequence[Float[np.ndarray, "_ 3"]],
) -> tuple[float, Float[np.ndarray, "3"]]:
    """Volume (m3) and centre of mass (m) of the convex hulls of the parts, at uniform density."""
    volume, moments = 0.0, np.zeros(3)
    for vertices in parts:
        hull = ConvexHull(vertices)
        inside = vertices[hull.vertices].mean(axis=0)
        triangles = vertices[hull.simplices] - inside
        # Qhull's triangles face either way, but every cone from a point inside is part of the volume.
        cones = np.abs(np.linalg.det(triangles)) / 6
        volume += float(cones.sum())
        moments += cones @ (triangles.sum(axis=1) / 4 + inside)
    return volume, moments / volume
