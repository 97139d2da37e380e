"""Normals for triangles that have none: smooth over round walls, sharp at edges."""

import numpy as np
import trimesh
from jaxtyping import Float

from sim.objects.object_model import VisualPart

CREASE_RAD = np.deg2rad(35.0)
"""Faces that meet at a larger angle keep a sharp edge between them."""


def shaded_part(triangles: Float[np.ndarray, "n 3 3"], colour: tuple[float, float, float]) -> VisualPart:
    """A visual part of triangles (m, counter-clockwise from outside) in one colour."""
    soup = trimesh.Trimesh(
        triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), process=False
    )
    soup.merge_vertices()
    mesh = trimesh.graph.smooth_shade(soup, angle=CREASE_RAD)
    return VisualPart(
        mesh.vertices.astype(np.float32),
        mesh.faces.astype(np.uint32),
        mesh.vertex_normals.astype(np.float32),
        colour,
    )
