"""Text files of the data set, read with a bound on their size."""

from pathlib import Path

from preshape.cornell.layout import ORIGIN
from preshape.errors import InputError

MAX_BYTES = 64 * 2**20


def read_lines(path: Path) -> list[str]:
    """The lines of an ASCII file that are not blank.

    Raises:
        InputError: if the file cannot be read, is larger than 64 MiB or is not ASCII text.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        problem = error.strerror or error
        raise InputError(
            f"The file cannot be read: {problem}", where=path, fix=f"check it; {ORIGIN}"
        ) from error
    if len(content) > MAX_BYTES or not content.isascii() or b"\0" in content:
        raise damaged(path, "it is no text, or too long")
    return [line for line in content.decode("ascii").splitlines() if line.strip()]


def damaged(path: Path, what: str) -> InputError:
    """The error that says what is wrong with a file of the data set."""
    return InputError(f"The file is damaged: {what}", where=path, fix=f"extract or copy it again; {ORIGIN}")
