"""Finished scenes on disk: one line each, with its checksum, added as soon as the scene is done."""

import fcntl
import hashlib
import json
import os
import socket
from collections.abc import Iterator
from dataclasses import dataclass, fields
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from preshape.data.scene import Scene
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import THETAS, SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.grasps.space import GraspSpace

SCENES_AT_ONCE = 1000
"""Scenes that are turned into columns together, so that a million trials need not be objects at once."""


@dataclass(frozen=True, eq=False)
class FinishedScene:
    """What came of the scene of one number.

    Args:
        scene_id: the number.
        scene: the scene; None if its object would not come to rest, or nothing could be tried on it.
        trials: the grasps that were tried on it.
    """

    scene_id: int
    scene: Scene | None
    trials: tuple[Trial, ...]


@dataclass(frozen=True, eq=False)
class BlockContent:
    """What a block's file holds.

    Args:
        finished: its finished scenes by number.
        damaged: number of lines that are cut off or do not fit their checksum.
        owner: the process that last added to it.
    """

    finished: dict[int, FinishedScene]
    damaged: int
    owner: str


class SceneBlock:
    """The file of consecutive scenes, which the one process that has claimed it adds to.

    Lines are only ever added. One that a crash cut off, or that was altered since, does not fit its checksum;
    its scene then counts as not finished, and is added once more. The claim is a lock of the operating
    system, which ends with the process however that ends.

    Args:
        path: the file.
        numbers: the numbers of its scenes.
    """

    def __init__(self, path: Path, numbers: range) -> None:
        self.path, self.numbers = path, numbers
        self._handle: int | None = None

    def read(self) -> BlockContent:
        """What is finished so far, also while another process adds to it.

        Raises:
            InputError: if the file cannot be read.
        """
        try:
            lines = self.path.read_bytes().splitlines() if self.path.exists() else []
        except OSError as error:
            raise refusal("read", self.path, error) from error
        contents = [content for content in map(_unseal, lines) if content is not None]
        owners = [content["owner"] for content in contents if "owner" in content]
        scenes = [_to_finished(content) for content in contents if "scene_id" in content]
        return BlockContent(
            finished={scene.scene_id: scene for scene in reversed(scenes)},
            damaged=sum(line != b"" for line in lines) - len(contents),
            owner=owners[-1] if owners else "Another process",
        )

    def claim(self) -> bool:
        """Try to become the only process that adds to this block; False if another one is.

        Raises:
            InputError: if the file cannot be written, or its file system has no locks.
        """
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # a line that was cut off must not swallow the next one
            size = os.fstat(self._handle).st_size
            if size and os.pread(self._handle, 1, size - 1) != b"\n":
                self._write(b"\n")
            self._write(_seal({"owner": f"Process {os.getpid()} on {socket.gethostname()}"}))
        except BlockingIOError:
            self.release()
            return False
        except OSError as error:
            self.release()
            raise refusal("written", self.path, error) from error
        return True

    def add(self, finished: FinishedScene) -> None:
        """Add a finished scene; it is safe on disk when this returns.

        Raises:
            InputError: if there is no space left, or the file cannot be written any more.
        """
        try:
            self._write(_seal(_from_finished(finished)))
        except OSError as error:
            raise refusal("written", self.path, error) from error

    def release(self) -> None:
        """Let another process claim the block."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None

    def _write(self, line: bytes) -> None:
        assert self._handle is not None
        while line:
            line = line[os.write(self._handle, line) :]
        os.fsync(self._handle)


def to_tables(
    finished: Iterator[FinishedScene], origin: TableOrigin, space: GraspSpace
) -> tuple[SceneTable, TrialTable]:
    """The scenes and trials as tables.

    Args:
        finished: finished scenes.
        origin, space: what the tables are about.
    """
    scenes: list[Scene] = []
    tables = []
    while some := list(islice(finished, SCENES_AT_ONCE)):
        scenes += [entry.scene for entry in some if entry.scene is not None]
        trials = [trial for entry in some for trial in entry.trials]
        if trials or not tables:
            tables.append(TrialTable.from_trials(trials, space, origin))
    rows = pd.concat([table.rows for table in tables if len(table)] or [tables[0].rows], ignore_index=True)
    thetas = (np.concatenate([getattr(table, name) for table in tables]) for name in THETAS)
    return SceneTable(origin, tuple(scenes)), TrialTable(origin, space, rows, *thetas)


def _seal(content: dict[str, Any]) -> bytes:
    """A line: checksum, space, JSON. NaN and every double come back as they were."""
    text = json.dumps(content, separators=(",", ":"), default=_plain).encode()
    return hashlib.sha256(text).hexdigest().encode() + b" " + text + b"\n"


def _unseal(line: bytes) -> dict[str, Any] | None:
    checksum, _, text = line.partition(b" ")
    if hashlib.sha256(text).hexdigest().encode() != checksum:
        return None
    content: dict[str, Any] = json.loads(text)
    return content


def _plain(value: Any) -> Any:
    """What JSON does not know: arrays and NumPy's numbers."""
    return value.tolist()


def _from_finished(finished: FinishedScene) -> dict[str, Any]:
    scene = finished.scene
    return {
        "scene_id": finished.scene_id,
        "scene": None if scene is None else {**vars(scene), "camera": vars(scene.camera)},
        "trials": [vars(trial) for trial in finished.trials],
    }


def _to_finished(content: dict[str, Any]) -> FinishedScene:
    row = content["scene"]
    scene = None if row is None else Scene(**_arrays(row) | {"camera": Camera(**_arrays(row["camera"]))})
    return FinishedScene(content["scene_id"], scene, tuple(map(_to_trial, content["trials"])))


def _to_trial(row: dict[str, Any]) -> Trial:
    kinds = {"face": Face(row["face"]), "outcome": TrialOutcome(row["outcome"])}
    return Trial(**{entry.name: (_arrays(row) | kinds)[entry.name] for entry in fields(Trial)})


def _arrays(row: dict[str, Any]) -> dict[str, Any]:
    return {name: np.array(value) if isinstance(value, list) else value for name, value in row.items()}


def refusal(what: str, path: Path, error: OSError) -> InputError:
    """What to tell the user if the place of finished scenes cannot be used.

    Args:
        what: what cannot be done: `read`, `written`.
        path: the file.
        error: what the operating system said.
    """
    return InputError(
        f"The finished scenes cannot be {what}: {error.strerror or error}",
        where=path,
        fix="free some space or choose another place with paths.cache=DIR; what is finished stays, and the "
        "same command goes on from there",
    )
