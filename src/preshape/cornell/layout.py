"""Where the Cornell grasp data set keeps its files."""

import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from preshape.errors import InputError

WIDTH, HEIGHT = 640, 480
"""Size of every image (pixels)."""
ORIGIN = (
    "the Cornell grasp data set is that of the Personal Robotics group, once at pr.cs.cornell.edu/grasping; "
    "copies are at kaggle.com/oneoneliu/cornell-grasp. docs/cornell.md says which files are read"
)
"""What to tell a user who lacks a part of it."""
COLOUR, POSITIVES, NEGATIVES, CLOUD, RANGE = "r.png", "cpos.txt", "cneg.txt", ".txt", "d.tiff"
OBJECT_LISTS = ("processedData/z.txt", "z.txt")
_NAME = re.compile(
    r"pcd(\d{4})(" + "|".join(map(re.escape, (COLOUR, POSITIVES, NEGATIVES, CLOUD, RANGE))) + ")"
)
_NAMED = 5
"""So many incomplete images are named in a message."""


@dataclass(frozen=True)
class ImageFiles:
    """The files of one image.

    Args:
        number: the image's number, as in `pcd0100r.png`.
        colour: PNG.
        positives, negatives: labelled rectangles.
        cloud: measured points; None if missing.
        range_image: distances from the robot's base as other tools save them; None if missing.
    """

    number: int
    colour: Path
    positives: Path
    negatives: Path
    cloud: Path | None
    range_image: Path | None

    @property
    def pictures(self) -> tuple[Path, ...]:
        """The files that its view is made of: colours, and points or else distances."""
        surface = self.range_image if self.cloud is None else self.cloud
        return (self.colour,) if surface is None else (self.colour, surface)


@dataclass(frozen=True)
class CornellFiles:
    """The files of a data set.

    Args:
        images: in the order of their numbers.
        objects: the list of the images' objects, `z.txt`.
    """

    images: tuple[ImageFiles, ...]
    objects: Path


def find_files(root: str | Path) -> CornellFiles:
    """Find the images in a folder and in its folders, whatever these are called (`01` to `10` at Cornell's).

    Every image needs its colours, both files of rectangles, and its points or its range image.

    Raises:
        InputError: if the folder or an image is not complete, or an image is there twice.
    """
    root = Path(root)
    if not root.is_dir():
        raise InputError("The folder of the data set does not exist", where=root, fix=f"check it; {ORIGIN}")
    found: dict[int, dict[str, Path]] = defaultdict(dict)
    for path in sorted((*root.glob("pcd*"), *root.glob("*/pcd*"))):
        match = _NAME.fullmatch(path.name)
        if match is None:
            continue
        own = found[int(match[1])]
        if match[2] in own:
            raise InputError(
                f"The data set has {path.name} twice",
                where=path,
                fix=f"keep one of them; the other is {own[match[2]]}",
            )
        own[match[2]] = path
    objects = next((root / name for name in OBJECT_LISTS if (root / name).is_file()), None)
    _check_complete(root, found, objects)
    assert objects is not None
    images = (_image_files(number, files) for number, files in sorted(found.items()))
    return CornellFiles(tuple(images), objects)


def _image_files(number: int, files: Mapping[str, Path]) -> ImageFiles:
    colour, positives, negatives = (files[kind] for kind in (COLOUR, POSITIVES, NEGATIVES))
    return ImageFiles(number, colour, positives, negatives, files.get(CLOUD), files.get(RANGE))


def _check_complete(root: Path, found: Mapping[int, Mapping[str, Path]], objects: Path | None) -> None:
    """Say what was found and what is missing, all in one."""
    lacking = {number: _lacking(number, files) for number, files in sorted(found.items())}
    broken = [f"image {number:04d} lacks {names}" for number, names in lacking.items() if names]
    missing = broken[:_NAMED]
    if len(broken) > _NAMED:
        missing.append(f"{len(broken) - _NAMED} more images lack something too")
    if not found:
        missing.append("the images pcdNNNNr.png with their files are missing")
    if objects is None:
        missing.append(f"the list of objects is missing ({' or '.join(OBJECT_LISTS)})")
    if missing:
        raise InputError(
            f"The data set is not complete: {len(found) - len(broken)} complete and {len(broken)} incomplete "
            f"images were found; {'; '.join(missing)}",
            where=root,
            fix=f"extract all archives into this folder; {ORIGIN}",
        )


def _lacking(number: int, files: Mapping[str, Path]) -> str:
    """Names of the files that an image needs and lacks."""
    names = [f"pcd{number:04d}{kind}" for kind in (COLOUR, POSITIVES, NEGATIVES) if kind not in files]
    if CLOUD not in files and RANGE not in files:
        names.append(f"pcd{number:04d}{CLOUD} or pcd{number:04d}{RANGE}")
    return ", ".join(names)
