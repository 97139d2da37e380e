"""Where the BigBIRD data set keeps the files of an object.

Singh, Sha, Narayan, Achim, Abbeel, "BigBIRD: A large-scale 3D database of object instances", ICRA 2014.
"""

from pathlib import Path

PROCESSED = "processed"
ORIGIN = "BigBIRD is a data set of Berkeley, offered for download at rll.berkeley.edu/bigbird"
"""What to tell a user who lacks a part of it."""


def bigbird_file(folder: Path, name: str) -> Path:
    """Path of a file in an object's folder, or under `processed` in it if it is only there.

    Args:
        folder: the object's folder.
        name: path of the file as the data set's authors give it, such as `meshes/poisson.ply`.
    """
    direct, processed = folder / name, folder / PROCESSED / name
    return processed if processed.is_file() and not direct.is_file() else direct
