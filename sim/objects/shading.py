"""What triangles look like: colours, textures, and normals smooth over round walls but sharp at edges."""

import numpy as np
from jaxtyping import Float, Num, UInt8
from scipy.sparse import csr_array

from sim.objects.colour import LinearColour
from sim.objects.object_model import VisualPart

CREASE_RAD = np.deg2rad(35.0)
"""Faces that meet at a larger angle keep a sharp edge between them."""
WELD_M = 1e-6


def shaded_part(triangles: Float[np.ndarray, "n 3 3"], colour: LinearColour) -> VisualPart:
    """Triangles (m, counter-clockwise from outside) in one linear RGB."""
    return _part(triangles, colour)


def textured_part(
    triangles: Float[np.ndarray, "n 3 3"],
    uvs: Float[np.ndarray, "n 3 2"],
    texture: UInt8[np.ndarray, "h w 3"],
) -> VisualPart:
    """Triangles (m) with an sRGB image; `uvs` are of the triangles' corners, v pointing up."""
    return _part(triangles, (1.0, 1.0, 1.0), uvs.reshape(-1, 2).astype(np.float32), texture)


def painted_part(triangles: Float[np.ndarray, "n 3 3"], colours: UInt8[np.ndarray, "n 3"]) -> VisualPart:
    """Triangles (m), each in its own sRGB colour: a texture with one pixel per triangle."""
    side = int(np.ceil(np.sqrt(len(triangles))))
    texture = np.zeros((side, side, 3), np.uint8)
    texture.reshape(-1, 3)[: len(triangles)] = colours
    row, column = np.divmod(np.arange(len(triangles)), side)
    pixel_centres = np.stack(((column + 0.5) / side, 1 - (row + 0.5) / side), axis=1)
    return textured_part(triangles, np.repeat(pixel_centres[:, None], 3, axis=1), texture)


def two_sided(triangles: Num[np.ndarray, "n 3 k"]) -> Num[np.ndarray, "m 3 k"]:
    """Each triangle, or what belongs to its corners, and its back: SAPIEN draws front sides only."""
    return np.concatenate((triangles, triangles[:, ::-1]))


def crease_normals(triangles: Float[np.ndarray, "n 3 3"]) -> Float[np.ndarray, "n 3 3"]:
    """Normal at each corner: the mean of the faces there that meet this one at less than the crease angle."""
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    units = crosses / np.maximum(np.linalg.norm(crosses, axis=1, keepdims=True), 1e-30)
    welded = np.round(triangles.reshape(-1, 3) / WELD_M).astype(np.int64)
    vertex_of_corner = np.unique(welded, axis=0, return_inverse=True)[1].ravel()
    corners = np.arange(len(vertex_of_corner))
    at_vertex = csr_array((np.ones(len(corners), np.int8), (corners, vertex_of_corner)))
    here, there = (at_vertex @ at_vertex.T).nonzero()
    smooth = np.einsum("ij,ij->i", units[here // 3], units[there // 3]) > np.cos(CREASE_RAD)
    sums = (
        csr_array((smooth.astype(float), (here, there // 3)), shape=(len(corners), len(triangles))) @ crosses
    )
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return (sums / np.maximum(lengths, 1e-30)).reshape(-1, 3, 3)


def _part(
    triangles: Float[np.ndarray, "n 3 3"],
    colour: LinearColour,
    uvs: Float[np.ndarray, "v 2"] | None = None,
    texture: UInt8[np.ndarray, "h w 3"] | None = None,
) -> VisualPart:
    return VisualPart(
        triangles.reshape(-1, 3).astype(np.float32),
        np.arange(3 * len(triangles), dtype=np.uint32).reshape(-1, 3),
        crease_normals(triangles).reshape(-1, 3).astype(np.float32),
        colour,
        uvs,
        texture,
    )
