"""Writing files so that they are there whole or not at all, and reading JSON that a user may have edited."""

import fcntl
import hashlib
import json
import math
import os
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from preshape.errors import InputError


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`: write there, and the file appears under its own name in one step.

    The temporary name keeps the suffix, because writers choose their format by it. Missing folders are made.
    If the body raises, or is interrupted, the temporary file goes and whatever stood at `path` stays.

    Raises:
        InputError: if the place cannot be written to (no space, no permission, read-only).
    """
    path = Path(path)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}-{secrets.token_hex(4)}{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        _flush_to_disk(temporary)
        temporary.replace(path)
        _flush_to_disk(path.parent)
    except OSError as error:
        about_this_file = (None, *map(str, (temporary, path, *path.parents)))
        if error.filename not in about_this_file:
            raise
        raise InputError(
            f"The file cannot be written: {error.strerror or error}",
            where=path,
            fix="free some space or choose another place; nothing half-written is left there",
        ) from error
    finally:
        with suppress(OSError):  # a folder that cannot be written to holds no temporary file of ours
            temporary.unlink(missing_ok=True)


@contextmanager
def exclusive(path: str | Path) -> Iterator[None]:
    """Keep other processes that ask for the same lock file out; waits until it is free.

    The file stays, empty. A process that is killed leaves the lock free.

    Raises:
        InputError: if the place cannot be written to.
    """
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = path.open("ab")
    except OSError as error:
        raise InputError(
            f"The lock file cannot be made: {error.strerror or error}", where=path, fix="choose another place"
        ) from error
    with handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def copy_files(source: Path, target: Path) -> None:
    """Copy all files below a folder to the same places below another one, each atomically.

    Raises:
        InputError: if the place cannot be written to.
    """
    for path in sorted(source.rglob("*")):
        if path.is_file():
            with atomic_path(target / path.relative_to(source)) as temporary:
                temporary.write_bytes(path.read_bytes())


def write_json(path: str | Path, content: Mapping[str, Any]) -> None:
    """Write an object as indented JSON, atomically.

    Arrays, tensors and their scalars become lists and numbers, paths become strings, and numbers that JSON
    does not know (NaN, infinity) become null.

    Raises:
        InputError: if the place cannot be written to.
    """
    text = json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False)
    with atomic_path(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def read_json(path: str | Path) -> dict[str, Any]:
    """Read a JSON file that holds an object.

    Raises:
        InputError: if the file is missing, unreadable, not JSON, or holds something else than an object.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError("The file does not exist", where=path, fix="check the path") from error
    except OSError as error:
        problem = error.strerror or error
        raise InputError(
            f"The file cannot be read: {problem}", where=path, fix="check the path and its permissions"
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"The file is not valid JSON: {error}", where=path, fix="write it again, or mend it by hand"
        ) from error
    if not isinstance(content, dict):
        raise InputError(
            f"The file holds a {type(content).__name__} where an object {{...}} is needed",
            where=path,
            fix="give the file that the command expects",
        )
    return content


def file_hash(path: str | Path) -> str:
    """SHA-256 of a file's content; raises InputError if it cannot be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError as error:
        problem = error.strerror or error
        raise InputError(f"The file cannot be read: {problem}", where=path, fix="check the path") from error


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value


def _flush_to_disk(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
