"""The BigBIRD data set's own folders as an object set: the scans that the authors of the paper simulate."""

import logging
from dataclasses import dataclass
from functools import cached_property
from multiprocessing import parent_process
from pathlib import Path

from preshape.errors import InputError
from preshape.perception.bigbird_layout import ORIGIN, PROCESSED, bigbird_file
from sim.objects.mesh_folder import MeshFolder, bare_mesh
from sim.objects.urdf import UrdfObject

log = logging.getLogger(__name__)

SOLID_MESH = "meshes/poisson.ply"
"""Closed by Poisson reconstruction: what is simulated."""
TEXTURED_MESH = "textured_meshes/optimized_tsdf_texture_mapped_mesh.obj"
"""What the camera sees."""
ARCHIVES = (".gz", ".tar", ".tgz", ".zip")
MOST_NAMES = 5


@dataclass(frozen=True)
class BigbirdFolder(MeshFolder):
    """The objects of a folder with one sub-folder for each, as an `ObjectSet`.

    An object's files lie in its sub-folder as the data set names them, or under `processed` in it. It
    collides as `meshes/poisson.ply` and looks like its textured mesh, if that is there. Objects without the
    former, as transparent ones often are, are left out with a warning.

    Args:
        name: name of the set.

    Raises:
        InputError: if the folder is missing or cannot be read, or no object has its mesh.
    """

    name: str = "bigbird"

    @cached_property
    def files(self) -> dict[str, Path]:
        """Name of each object -> the mesh as which it collides."""
        folders = self._object_folders()
        files = {folder.name: bigbird_file(folder, SOLID_MESH) for folder in folders}
        missing = [name for name, path in files.items() if not path.is_file()]
        if len(missing) == len(files):
            raise self._incomplete(folders)
        if missing and parent_process() is None:  # workers would only say it again
            log.warning("%s: left out for want of %s: %s", self.root, SOLID_MESH, ", ".join(missing))
        return {name: path for name, path in files.items() if name not in missing}

    @property
    def sources(self) -> list[Path]:
        """The files that the models depend on."""
        looks = (bigbird_file(self.root / name, TEXTURED_MESH).parent for name in self.names)
        shown = [path for folder in looks if folder.is_dir() for path in folder.iterdir() if path.is_file()]
        return sorted([*self.files.values(), *shown])

    def shape(self, name: str) -> UrdfObject:
        """The two meshes of an object."""
        looks = bigbird_file(self.root / name, TEXTURED_MESH)
        return UrdfObject(None, (bare_mesh(self.files[name]),), (bare_mesh(looks),))

    def _object_folders(self) -> list[Path]:
        if not self.root.is_dir():
            raise self._unusable("The folder does not exist")
        if bigbird_file(self.root, SOLID_MESH).is_file():
            raise InputError(
                "This is the folder of one object, not of the data set",
                where=self.root,
                fix=f"set objects.root to the folder around it: {self.root.parent}",
            )
        try:
            return sorted(path for path in self.root.iterdir() if path.is_dir() and path.name[0] != ".")
        except OSError as error:
            raise self._unusable(f"The folder cannot be read: {error.strerror}") from error

    def _incomplete(self, folders: list[Path]) -> InputError:
        archives = sorted(path.name for path in self.root.rglob("*") if path.suffix in ARCHIVES)
        textured = [path.name for path in folders if bigbird_file(path, TEXTURED_MESH).is_file()]
        found = (
            _counted("sub-folder", [path.name for path in folders]),
            _counted("textured object", textured),
            _counted("archive", archives),
        )
        return self._unusable(f"No object has its {SOLID_MESH}; found: {'; '.join(found)}")

    def _unusable(self, what: str) -> InputError:
        fix = (
            f"set objects.root to a folder that holds NAME/{SOLID_MESH} or NAME/{PROCESSED}/{SOLID_MESH}, "
            f"with all archives extracted. {ORIGIN}"
        )
        return InputError(what, where=self.root, fix=fix)


def _counted(what: str, names: list[str]) -> str:
    """How many of something there are, and the first of them."""
    shown = ", ".join([*names[:MOST_NAMES], *(["..."] if len(names) > MOST_NAMES else [])])
    return f"{what}s: {len(names)}" + (f" ({shown})" if names else "")
