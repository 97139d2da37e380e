"""The data set: its images with their objects and labelled rectangles."""

import hashlib
import logging
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from preshape.cornell.layout import ORIGIN, ImageFiles, find_files
from preshape.cornell.object_list import Subject, read_object_list
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_files import Flaw, read_rectangles
from preshape.cornell.text_files import damaged
from preshape.errors import InputError

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class CornellImage:
    """An image and its labels.

    Args:
        files: where it lies.
        subject: what it shows.
        positives, negatives: usable rectangles, where a gripper could and could not grasp.
    """

    files: ImageFiles
    subject: Subject
    positives: tuple[GraspRectangle, ...]
    negatives: tuple[GraspRectangle, ...]


@dataclass(frozen=True)
class CornellDataSet:
    """All images of a folder.

    Args:
        images: in the order of their numbers.
        dropped: how many rectangles were left out, by their flaw.
    """

    images: tuple[CornellImage, ...]
    dropped: dict[Flaw, int]

    @property
    def objects(self) -> dict[int, int]:
        """Object of each image, by the image's number: what `preshape.cornell.folds` deals."""
        return {image.files.number: image.subject.object_id for image in self.images}

    @property
    def names(self) -> dict[int, str]:
        """Name of each image's object, by the image's number: its category, which is one object's in ours."""
        return {image.files.number: image.subject.category for image in self.images}

    @property
    def digest(self) -> str:
        """Digest of the labels and of the images' sizes, by which a trained network names its data."""
        told = [
            (
                *(image.files.number, image.subject, image.positives, image.negatives),
                [path.stat().st_size for path in image.files.pictures],
            )
            for image in self.images
        ]
        return hashlib.sha256(repr(told).encode()).hexdigest()


def read_cornell(root: str | Path) -> CornellDataSet:
    """Read the labels of all images in a folder; the images themselves are read by `load_cornell_view`.

    Rectangles that cannot be used are left out, and one line of the log says how many and where.

    Raises:
        InputError: if the data set is not complete, or a file of it is truncated or damaged.
    """
    files = find_files(root)
    subjects = read_object_list(files.objects)
    unknown = [f"{own.number:04d}" for own in files.images if own.number not in subjects]
    if unknown:
        raise InputError(
            f"The list of objects lacks {len(unknown)} images, such as {unknown[0]}",
            where=files.objects,
            fix=f"extract it again: it may be truncated; {ORIGIN}",
        )
    dropped: Counter[Flaw] = Counter(dict.fromkeys(Flaw, 0))
    flawed: list[str] = []
    images = []
    for own in files.images:
        positives, negatives = read_rectangles(own.positives), read_rectangles(own.negatives)
        if not positives.usable and not positives.dropped:
            raise damaged(own.positives, "it is empty, but every image has positive rectangles")
        for path, labelled in ((own.positives, positives), (own.negatives, negatives)):
            dropped.update(labelled.dropped)
            flawed.extend([path.stem] * bool(labelled.dropped))
        images.append(CornellImage(own, subjects[own.number], positives.usable, negatives.usable))
    if flawed:
        reasons = ", ".join(f"{count} {flaw}" for flaw, count in dropped.items() if count)
        log.warning("Left out %d rectangles: %s (in %s)", dropped.total(), reasons, ", ".join(flawed))
    return CornellDataSet(tuple(images), dict(dropped))
