"""Reading triangle meshes of any common format, as they are: no repair, no network, no code."""

import logging
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import UInt8
from PIL import Image

from preshape.errors import InputError
from preshape.perception.view_files import BROKEN_IMAGE
from sim.objects.colour import LinearColour, linear_rgb
from sim.objects.object_model import VisualPart
from sim.objects.shading import painted_part, shaded_part, textured_part, two_sided

logging.getLogger("trimesh").setLevel(logging.WARNING)

MESH_SUFFIXES = (".glb", ".gltf", ".obj", ".off", ".ply", ".stl")
IMAGE_SUFFIXES = (".jpeg", ".jpg", ".png")
LARGEST_M = 1.0
SMALLEST_M = 0.005
THINNEST_M = 0.0002
UNDECLARED_COLOUR = trimesh.visual.material.SimpleMaterial().main_color
UNDECLARED_TEXTURE = trimesh.visual.material.color_image()
"""What trimesh says of a material that a mesh names and no file declares."""
TEXTURE_PIXELS = 1024
"""Textures are shrunk to this many pixels along a side; the object covers fewer in the image."""


def read_mesh_file(path: Path) -> list[trimesh.Trimesh]:
    """The meshes of a file, each group of an OBJ by itself, in the file's units and frame.

    Raises:
        InputError: if the file is missing, unreadable or holds no triangles.
    """
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise _unusable("The mesh is in a format that is not read", path)
    groups: dict[str, Any] = {}
    if path.suffix.lower() == ".obj":
        groups = {"split_objects": True, "split_groups": True}
    try:
        scene = trimesh.load_scene(path, process=False, allow_remote=False, **groups)
        meshes = [mesh for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
        _load_textures(meshes)
        finite = all(np.isfinite(mesh.triangles).all() for mesh in meshes)
    except Exception as error:  # a broken file surfaces as whatever its reader trips over
        raise _unusable(f"The mesh cannot be read ({error})", path) from error
    if not meshes:
        raise _unusable("The mesh holds no triangles", path)
    if sum(len(mesh.faces) for mesh in meshes) < _declared_faces(path):
        raise _unusable("The mesh is truncated: it has fewer faces than its header says", path)
    if not finite:
        raise _unusable("The mesh has corners that are not finite", path)
    return meshes


def check_size(meshes: Sequence[trimesh.Trimesh], path: Path) -> None:
    """Refuse what cannot be an object for one hand in metres; raises `InputError`."""
    extents = np.ptp(np.concatenate([mesh.bounds for mesh in meshes]), axis=0)
    extent = float(extents.max())
    if extent > LARGEST_M:
        raise InputError(
            f"The mesh is {extent:.4g} m large, which looks like millimetres",
            where=path,
            fix="set objects.scale=0.001 (0.01 if it is in centimetres)",
        )
    if extent < SMALLEST_M:
        raise InputError(
            f"The mesh is only {extent:.2g} m large, too tiny to grasp",
            where=path,
            fix="set objects.scale to the length of the mesh's unit in metres",
        )
    if extents.min() < THINNEST_M:
        raise InputError("The mesh is flat and encloses nothing", where=path, fix="give a mesh with a volume")


def visual_part(mesh: trimesh.Trimesh, plain: LinearColour) -> VisualPart:
    """What a mesh looks like: its texture, its vertex or face colours, or else the `plain` colour."""
    triangles, visual = np.asarray(mesh.triangles), mesh.visual
    sides = (lambda corners: corners) if _is_closed(mesh) else two_sided
    if visual.kind == "texture":
        image = _texture(visual.material)
        if image is not None and visual.uv is not None:
            return textured_part(sides(triangles), sides(visual.uv[mesh.faces]), _pixels(image))
        declared = visual.material.main_color
        if declared is not None and not np.array_equal(declared, UNDECLARED_COLOUR):
            plain = linear_rgb(np.asarray(declared[:3]))
    elif visual.kind is not None:
        colours = np.asarray(visual.face_colors)[:, :3]
        return painted_part(sides(triangles), np.resize(colours, (len(sides(triangles)), 3)))
    return shaded_part(sides(triangles), plain)


def mean_colour(path: Path) -> LinearColour:
    """Mean colour of an image but for its black, unused parts; raises `InputError` if it cannot be read."""
    try:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert("RGB").resize((64, 64))).reshape(-1, 3)
    except BROKEN_IMAGE as error:
        raise InputError("The texture cannot be read", where=path, fix="replace the image") from error
    used = pixels[pixels.sum(axis=1) > 0]
    return linear_rgb(used.mean(axis=0) if len(used) else np.zeros(3))


def _is_closed(mesh: trimesh.Trimesh) -> bool:
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    surface.merge_vertices()
    return bool(surface.is_volume)


def _declared_faces(path: Path) -> int:
    """Number of faces of which the header of a PLY speaks, or 0; trimesh reads a shorter text for whole."""
    if path.suffix.lower() != ".ply":
        return 0
    header = path.read_bytes().partition(b"end_header")[0]
    declared = re.search(rb"^element face (\d+)", header, re.MULTILINE)
    return int(declared[1]) if declared else 0


def _load_textures(meshes: Sequence[trimesh.Trimesh]) -> None:
    """Decode what Pillow has only opened so far, so that a damaged image shows now."""
    for mesh in meshes:
        image = _texture(mesh.visual.material) if mesh.visual.kind == "texture" else None
        if image is not None:
            image.load()


def _texture(material: Any) -> Image.Image | None:
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    placeholder = UNDECLARED_TEXTURE
    if image is None or (image.size == placeholder.size and image.tobytes() == placeholder.tobytes()):
        return None
    return image


def _pixels(image: Image.Image) -> UInt8[np.ndarray, "h w 3"]:
    small = image.convert("RGB")
    small.thumbnail((TEXTURE_PIXELS, TEXTURE_PIXELS))
    return np.asarray(small)


def _unusable(what: str, path: Path) -> InputError:
    return InputError(what, where=path, fix=f"replace the file; {', '.join(MESH_SUFFIXES)} are read")
