"""Which object an image shows: `z.txt` of the data set."""

import re
from dataclasses import dataclass
from pathlib import Path

from preshape.cornell.text_files import damaged, read_lines

_LINE = re.compile(r"(\d{1,4})\s+(\d{1,6})\s+(\S+)\s+(\S+)")


@dataclass(frozen=True)
class Subject:
    """What an image shows.

    Args:
        object_id: number of the object.
        category: what it is, such as `Stapler`.
        background: name of the picture of the empty table, such as `pcdb_0002`.
    """

    object_id: int
    category: str
    background: str


def read_object_list(path: Path) -> dict[int, Subject]:
    """Subject of each image by its number, from lines `image object category background`.

    Images occur once for each rectangle.

    Raises:
        InputError: if the file cannot be read, is truncated, or contradicts itself.
    """
    subjects: dict[int, Subject] = {}
    for line in read_lines(path):
        match = _LINE.fullmatch(line.strip())
        if match is None:
            raise damaged(path, f"{line.strip()[:60]!r} is not `image object category background`")
        number, subject = int(match[1]), Subject(int(match[2]), match[3], match[4])
        if subjects.setdefault(number, subject) != subject:
            raise damaged(path, f"it says two things about image {number:04d}")
    return subjects
