"""Any folder of URDFs or meshes as an object set, so that scans can be grasped.

A folder that holds a URDF is one object (several URDFs: several objects), and its meshes are the URDF's. A
folder without a URDF gives one object per mesh file. The root itself and its direct sub-folders are read.
"""

import hashlib
import logging
from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import trimesh

from preshape.errors import InputError
from sim.objects.colour import LinearColour
from sim.objects.convex_decomposition import ConvexSettings, convex_parts
from sim.objects.mesh_files import (
    IMAGE_SUFFIXES,
    MESH_SUFFIXES,
    check_size,
    mean_colour,
    read_mesh_file,
    visual_part,
)
from sim.objects.object_model import PAPER_DENSITY, PAPER_FRICTION, ObjectModel, volume_and_centroid
from sim.objects.resting_pose import stood_up
from sim.objects.urdf import UrdfMesh, UrdfObject, read_object_urdf

log = logging.getLogger(__name__)

URDF_SUFFIX = ".urdf"
GREY: LinearColour = (0.4, 0.4, 0.4)


@dataclass(frozen=True)
class MeshFolder:
    """The objects of a folder as an `ObjectSet`.

    Args:
        root: the folder.
        cache: where convex decompositions are kept.
        name: name of the set.
        scale: metres per unit of the meshes.
        density: kg/m3, where a URDF gives no mass.
        friction: Coulomb coefficient.
        convex: how finely meshes are decomposed that are not convex.

    Raises:
        InputError: if the folder is missing or holds no objects.
    """

    root: Path
    cache: Path
    name: str = "mesh_folder"
    scale: float = 1.0
    density: float = PAPER_DENSITY
    friction: float = PAPER_FRICTION
    convex: ConvexSettings = field(default_factory=ConvexSettings)

    def __post_init__(self) -> None:
        object.__setattr__(self, "root", Path(self.root).expanduser().resolve())
        object.__setattr__(self, "cache", Path(self.cache))
        if self.scale <= 0:
            raise InputError(
                "The scale is not positive",
                where="objects.scale",
                fix="give the metres per unit of the meshes",
            )
        if not self.files:
            raise self._unusable("The folder holds no meshes and no URDF")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects, sorted."""
        return tuple(sorted(self.files))

    @cached_property
    def fingerprint(self) -> str:
        """Hash of the settings and of all files that the models depend on."""
        settings = (self.scale, self.density, self.friction, astuple(self.convex))
        digest = hashlib.sha256(repr(settings).encode())
        for path in self.sources:
            digest.update(str(path.relative_to(self.root)).encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
        return digest.hexdigest()

    @property
    def sources(self) -> list[Path]:
        """The files that the models may depend on: all beside which an object lies."""
        folders = sorted({path.parent for path in self.files.values()})
        return [path for folder in folders for path in sorted(folder.iterdir()) if path.is_file()]

    @cached_property
    def files(self) -> dict[str, Path]:
        """Name of each object -> its URDF or mesh."""
        if not self.root.is_dir():
            raise self._unusable("The folder does not exist")
        files: dict[str, Path] = {}
        for folder in (self.root, *sorted(path for path in self.root.iterdir() if path.is_dir())):
            found = _files_with(folder, (URDF_SUFFIX,)) or _files_with(folder, MESH_SUFFIXES)
            for path in found:
                name = self._object_name(path, alone=len(found) == 1)
                if name in files:
                    raise InputError(
                        f"Two files are named for the object {name!r}, the other being {files[name].name}",
                        where=path,
                        fix="rename or remove one of them",
                    )
                files[name] = path
        return files

    def load(self, name: str) -> ObjectModel:
        """The model of one object.

        It stands as it was modelled, with z up, if that is stable, and as it would most probably land if not.

        Raises:
            InputError: for an unknown name, and for files that cannot be read or are not in metres.
        """
        if name not in self.files:
            choices = ", ".join(self.names)
            raise InputError(
                f"The folder has no object {name!r}", where=self.root, fix=f"choose one of: {choices}"
            )
        return _build(self, name)

    def shape(self, name: str) -> UrdfObject:
        """The meshes of one object; raises `InputError` if its URDF cannot be read."""
        path = self.files[name]
        if path.suffix.lower() == URDF_SUFFIX:
            return read_object_urdf(path)
        return UrdfObject(None, (bare_mesh(path),), (bare_mesh(path),))

    def _object_name(self, path: Path, *, alone: bool) -> str:
        if path.parent == self.root:
            return path.stem
        return path.parent.name if alone else f"{path.parent.name}_{path.stem}"

    def _unusable(self, what: str) -> InputError:
        fix = "set objects.root to a folder of URDFs or meshes, or of sub-folders that hold them"
        return InputError(what, where=self.root, fix=fix)


def bare_mesh(path: Path) -> UrdfMesh:
    """A mesh file as if a URDF named it."""
    return UrdfMesh(path, np.ones(3), np.eye(4), None)


@cache
def _build(folder: MeshFolder, name: str) -> ObjectModel:
    urdf = folder.shape(name)
    collisions, visuals = _shapes_that_exist(urdf)
    solids = [part for mesh in collisions for part in _placed(mesh, folder.scale)]
    parts = convex_parts(solids, folder.convex, folder.cache)
    colour = _texture_colour([folder.files[name].parent, *(mesh.path.parent for mesh in visuals)])
    looks = tuple(
        visual_part(part, colour or mesh.colour or GREY)
        for mesh in visuals
        for part in _placed(mesh, folder.scale)
    )
    mass = urdf.mass_kg or folder.density * volume_and_centroid(parts)[0]
    return stood_up(ObjectModel(name, parts, looks, mass, folder.friction).centred())


def _placed(mesh: UrdfMesh, scale: float) -> list[trimesh.Trimesh]:
    """The meshes of a file in the object's frame, in metres."""
    placed = read_mesh_file(mesh.path)
    pose = mesh.T_link_mesh.copy()
    pose[:3, 3] *= scale
    for part in placed:
        part.apply_transform(pose @ np.diag([*(mesh.scale * scale), 1.0]))
    check_size(placed, mesh.path)
    return placed


def _shapes_that_exist(urdf: UrdfObject) -> tuple[Sequence[UrdfMesh], Sequence[UrdfMesh]]:
    """Collision and visual meshes of a URDF whose files may be missing.

    A visual mesh that is not there is replaced by another one of the folder. Without visual meshes the
    collision meshes are shown; without collision meshes the visual ones collide.
    """
    found = (mesh if mesh.path.is_file() else _stand_in(mesh, urdf) for mesh in urdf.visuals)
    visuals = [mesh for mesh in found if mesh is not None]
    colour = next((mesh.colour for mesh in urdf.visuals if mesh.colour), None)
    shown = visuals or [replace(mesh, colour=colour) for mesh in urdf.collisions]
    return urdf.collisions or visuals or urdf.visuals, shown


def _stand_in(missing: UrdfMesh, urdf: UrdfObject) -> UrdfMesh | None:
    solid = {mesh.path.name for mesh in urdf.collisions}
    meshes = [path for path in _files_with(missing.path.parent, MESH_SUFFIXES) if path.name not in solid]
    if not meshes:
        return None
    chosen = min(meshes, key=lambda path: ("visual" not in path.name, "textur" not in path.name, path.name))
    log.debug("%s is missing; %s is shown instead", missing.path, chosen.name)
    return replace(missing, path=chosen)


def _texture_colour(folders: Sequence[Path]) -> LinearColour | None:
    """Mean colour of the texture beside an object, for meshes that cannot carry it; None without one."""
    images = [image for folder in folders for image in _files_with(folder, IMAGE_SUFFIXES)]
    return mean_colour(images[0]) if images else None


def _files_with(folder: Path, suffixes: tuple[str, ...]) -> list[Path]:
    """Files of a folder with these suffixes, sorted; none if there is no folder."""
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in suffixes and path.is_file())
