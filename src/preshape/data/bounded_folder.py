"""A folder of derived files that keeps to a size and that anyone may delete at any moment."""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from preshape.errors import InputError
from preshape.files import atomic_path

SPARE = 0.1
"""Share of the bound that is made free at once when it is reached, because finding old files takes time."""
SHARERS = 64
"""So many processes can write at the same time and keep to the bound."""
TRIES = 5


class BoundedFolder:
    """Files by name; the least recently used ones go when there are too many.

    Several processes may share it. A file is there whole or not at all.

    Args:
        folder: where the files lie; made when it is needed.
        max_bytes: how much they may take.
    """

    def __init__(self, folder: str | Path, max_bytes: int) -> None:
        self.folder, self.max_bytes = Path(folder), max_bytes
        self._room = 0

    def path(self, name: str) -> Path:
        """Where the file of that name lies, or would lie; not all in one folder, which would be slow."""
        return self.folder / name[:2] / name

    def use(self, name: str) -> bool:
        """Whether there is a file of that name, which is now the most recently used."""
        try:
            os.utime(self.path(name))
        except FileNotFoundError:
            return False
        except OSError:  # of another user, or read-only: it is there
            return self.path(name).is_file()
        return True

    def read(self, name: str, size: int = -1) -> bytes | None:
        """Content of a file, which is now the most recently used; None if there is none.

        Args:
            name: the file.
            size: read so many bytes at most; -1 for all.
        """
        try:
            with self.path(name).open("rb") as file:
                content = file.read(size)
        except OSError:
            return None
        self.use(name)
        return content

    def write(self, name: str, content: bytes) -> None:
        """Write a file.

        Raises:
            InputError: if the folder cannot be written to.
        """
        self._room -= len(content)
        if self._room < 0:
            self._make_room(len(content))
        for tries_left in reversed(range(TRIES)):
            try:
                with atomic_path(self.path(name)) as temporary:
                    temporary.write_bytes(content)
                return
            except InputError as error:
                # Someone deleted the folder while the file was written.
                if not isinstance(error.__cause__, FileNotFoundError) or not tries_left:
                    raise

    def _make_room(self, needed: int) -> None:
        """Find out how much there is, and remove what was not used for the longest time if it is too much."""
        files = sorted(self._files())
        total = needed + sum(size for _, size, _ in files)
        if total > self.max_bytes:
            for _, size, path in files:
                if total <= (1 - SPARE) * self.max_bytes:
                    break
                with suppress(OSError):
                    path.unlink(missing_ok=True)
                    total -= size
        self._room = (self.max_bytes - total) // SHARERS

    def _files(self) -> Iterator[tuple[int, int, Path]]:
        """Time of last use, size and path of every file, unfinished ones included."""
        for path in self.folder.glob("*/*"):
            with suppress(OSError):
                status = path.stat()
                yield status.st_mtime_ns, status.st_size, path
