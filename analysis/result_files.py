"""The versioned result files, and where each of their numbers comes from."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from preshape.errors import InputError
from preshape.files import file_hash, read_json

PROVENANCE = ("command", "git_revision", "versions", "seed", "date")
"""What every result file starts with."""


@dataclass(frozen=True)
class Origin:
    """One run of a command that gave numbers to a result file.

    Args:
        what: which of its numbers; empty for all that no other origin names.
        command, git_revision, date: as the file records them; empty where it says nothing.
    """

    what: str
    command: str
    git_revision: str
    date: str


@dataclass(frozen=True, eq=False)
class ResultFile:
    """A result file.

    Args:
        name: its name without folder and suffix.
        content: what it holds.
        sha256: hash of the file.
    """

    name: str
    content: Mapping[str, Any]
    sha256: str

    @property
    def origins(self) -> list[Origin]:
        """The runs of commands behind its numbers, that of the file itself first."""
        return list(dict.fromkeys(_origins(self.content)))

    @property
    def data(self) -> str | None:
        """Hash of the trial tables that it is about, where it records one."""
        known = self.content.get("data")
        return known if isinstance(known, str) else None


class ResultFiles:
    """The result files of a folder, by name; those that are not there yet are None.

    Args:
        folder: where they lie.

    Raises:
        InputError: if there is none, or one cannot be read or does not say where it comes from.
    """

    def __init__(self, folder: str | Path) -> None:
        paths = sorted(Path(folder).glob("*.json"))
        if not paths:
            raise InputError(
                "There is no result file", where=folder, fix="give the folder results with report.results=DIR"
            )
        self._files = {path.stem: _read(path) for path in paths}

    def __iter__(self) -> Iterator[ResultFile]:
        return iter(self._files.values())

    def find(self, name: str) -> Mapping[str, Any] | None:
        """What a result file holds; None if it is not there yet."""
        found = self._files.get(name)
        return None if found is None else found.content


def _read(path: Path) -> ResultFile:
    content = read_json(path)
    lacking = [key for key in PROVENANCE if key not in content]
    if lacking:
        raise InputError(
            f"The result file does not say its {', '.join(lacking)}",
            where=path,
            fix="make it again with its command, or move it away",
        )
    return ResultFile(path.stem, content, file_hash(path))


def _origins(content: Mapping[str, Any], what: str = "") -> Iterator[Origin]:
    if {"command", "git_revision"} <= content.keys():
        about = (str(content.get(key, "")) for key in ("command", "git_revision", "date"))
        yield Origin(what, *about)
    for name, condition in content.get("conditions", {}).items():
        yield from _origins(condition, f"{what} {name}".strip())
    if isinstance(inner := content.get("paper_network"), Mapping):
        yield from _origins(inner, "with config-CNN:")
    for row in content.get("runs", ()):
        if "command" in row:
            named = (row.get("data"), row.get("folds"))
            yield from _origins(row, ", ".join(str(part) for part in named if isinstance(part, str)))
