"""Convex parts of any mesh: as given where it consists of such, else closed and cut by CoACD, kept on disk.

Wei et al., "Approximate Convex Decomposition for 3D Meshes with Collision-Aware Concavity and Tree Search",
SIGGRAPH 2022.
"""

import hashlib
import logging
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from importlib.metadata import version
from pathlib import Path

import coacd
import numpy as np
import open3d as o3d
import trimesh
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from preshape.files import atomic_path

log = logging.getLogger(__name__)

MOST_VERTICES = 128
"""PhysX takes convex hulls of at most 255 faces, which 128 vertices never exceed."""
MOST_TESTED_FACES = 300
"""Of finer meshes an even sample of the faces is tested for convexity, which scans fail at once."""
MOST_DECOMPOSED_FACES = 5_000
"""Finer meshes are thinned to this before CoACD, which takes minutes for the 100,000 faces of a scan."""
CONVEX_TOLERANCE = 0.02
"""A piece is convex if no face lies deeper in its hull than this share of its size."""


@dataclass(frozen=True)
class ConvexSettings:
    """How finely CoACD follows a mesh.

    Args:
        concavity: CoACD's threshold: largest concavity left in a part, as a share of the mesh's size.
        most_parts: upper bound of the number of parts.
        seed: of CoACD's tree search.
    """

    concavity: float = 0.05
    most_parts: int = 16
    seed: int = 0


def convex_parts(
    meshes: Sequence[trimesh.Trimesh], settings: ConvexSettings, cache: Path
) -> tuple[Float[np.ndarray, "_ 3"], ...]:
    """Vertices (m) of convex parts that fill the meshes.

    Meshes whose connected pieces are all convex keep them as they are; others are closed and decomposed, and
    the result is kept in the folder `cache`, which anyone may delete.
    """
    pieces = [piece for mesh in meshes for piece in _connected_pieces(mesh)]
    if pieces and all(_is_convex(piece) for piece in pieces):
        parts = [np.asarray(piece.vertices) for piece in pieces]
    else:
        parts = _cached_decomposition(_closed(trimesh.util.concatenate(list(meshes))), settings, cache)
    return tuple(_few_vertices(part) for part in parts)


def _welded(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The bare surface, with vertices joined that only differ in normal or texture."""
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    surface.merge_vertices()
    surface.update_faces(surface.nondegenerate_faces())
    surface.remove_unreferenced_vertices()
    return surface


def _closed(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The welded surface, thinned, its holes filled: CoACD would take an open one for a thin shell."""
    surface = _welded(mesh)
    if surface.is_watertight and len(surface.faces) <= MOST_DECOMPOSED_FACES:
        return surface
    # Each step's result may lie in the memory of the one before, so all are kept until the copy at the end.
    scan = o3d.t.geometry.TriangleMesh(
        o3d.core.Tensor(np.asarray(surface.vertices)), o3d.core.Tensor(np.asarray(surface.faces))
    )
    filled = scan.fill_holes()
    excess = 1 - MOST_DECOMPOSED_FACES / len(filled.triangle.indices)
    thinned = filled.simplify_quadric_decimation(excess) if excess > 0 else filled
    vertices, faces = thinned.vertex.positions.numpy().copy(), thinned.triangle.indices.numpy().copy()
    closed = _welded(trimesh.Trimesh(vertices, faces, process=False))
    trimesh.repair.fix_normals(closed)
    return closed


def _connected_pieces(mesh: trimesh.Trimesh) -> list[trimesh.Trimesh]:
    return list(_welded(mesh).split(only_watertight=False, repair=False))


def _is_convex(piece: trimesh.Trimesh) -> bool:
    try:
        hull = ConvexHull(piece.vertices)
    except QhullError:
        return False
    some = piece.triangles_center[:: 1 + len(piece.faces) // MOST_TESTED_FACES]
    depths = -(some @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    return bool(depths.max() < CONVEX_TOLERANCE * np.ptp(piece.vertices, axis=0).max())


def _cached_decomposition(
    mesh: trimesh.Trimesh, settings: ConvexSettings, cache: Path
) -> list[Float[np.ndarray, "_ 3"]]:
    vertices, faces = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int32)
    key = hashlib.sha256(repr((astuple(settings), version("coacd"))).encode())
    key.update(vertices.tobytes())
    key.update(faces.tobytes())
    path = cache / f"{key.hexdigest()[:32]}.npz"
    parts = _read_parts(path)
    if parts is None:
        log.info("decomposing a mesh of %d faces into convex parts", len(faces))
        parts = _decompose(vertices, faces, settings)
        with atomic_path(path) as temporary, temporary.open("wb") as file:
            np.savez(file, *parts)
    return parts


def _read_parts(path: Path) -> list[Float[np.ndarray, "_ 3"]] | None:
    """The remembered parts; None if there are none or the file is damaged."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            return [archive[f"arr_{number}"] for number in range(len(archive.files))]
    except FileNotFoundError:
        return None
    except Exception:
        log.warning("%s is damaged and is made again", path)
        return None


def _decompose(
    vertices: Float[np.ndarray, "v 3"], faces: np.ndarray, settings: ConvexSettings
) -> list[Float[np.ndarray, "_ 3"]]:
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=settings.concavity,
        max_convex_hull=settings.most_parts,
        seed=settings.seed,
    )
    return [np.asarray(points, np.float64) for points, _ in parts]


def _few_vertices(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "m 3"]:
    """Corners of the convex hull; of a round one, those that reach farthest in evenly spread directions."""
    corners = points[np.sort(ConvexHull(points).vertices)]
    if len(corners) <= MOST_VERTICES:
        return corners
    farthest = np.argmax(_directions(MOST_VERTICES) @ (corners - corners.mean(axis=0)).T, axis=1)
    return corners[np.unique(farthest)]


def _directions(count: int) -> Float[np.ndarray, "count 3"]:
    """Unit vectors spread evenly over the sphere (Fibonacci lattice)."""
    number = np.arange(count) + 0.5
    z = 1 - 2 * number / count
    azimuth = np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - z**2)
    return np.stack((radius * np.cos(azimuth), radius * np.sin(azimuth), z), axis=1)
