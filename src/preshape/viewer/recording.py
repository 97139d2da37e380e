"""What the simulator did in one trial, as numbers: enough to see it again without the simulator."""

import zipfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from preshape.data.trial import TrialOutcome
from preshape.errors import InputError
from preshape.files import atomic_path

FORMAT = "preshape-recording/1"
"""Name and version of the format; raised whenever old files could be misread."""


@dataclass(frozen=True, eq=False)
class TrialRecording:
    """States of an executed trial at t instants. Poses are in the world (m).

    Args:
        outcome: how it ended.
        joint_names: joints of the arm and the hand.
        times_s: seconds since the arm began to move.
        phases: what the robot was doing: transit, approach, close, lift, hold.
        joints: joint positions (rad or m).
        T_world_palm, T_world_object: poses of palm frame and object.
        contact_instants: for each of c contacts between hand and object the instant that it belongs to.
        contact_points: where they touched.
        contact_parts: with what: the name of the finger, or `palm`.
    """

    outcome: TrialOutcome
    joint_names: tuple[str, ...]
    times_s: Float64[np.ndarray, "t"]
    phases: tuple[str, ...]
    joints: Float64[np.ndarray, "t n"]
    T_world_palm: Float64[np.ndarray, "t 4 4"]
    T_world_object: Float64[np.ndarray, "t 4 4"]
    contact_instants: Int64[np.ndarray, "c"]
    contact_points: Float64[np.ndarray, "c 3"]
    contact_parts: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.times_s)

    def joints_at(self, instant: int) -> dict[str, float]:
        """Joint positions by name."""
        return dict(zip(self.joint_names, self.joints[instant].tolist(), strict=True))

    def contacts_at(self, instant: int) -> tuple[Float64[np.ndarray, "k 3"], tuple[str, ...]]:
        """Points where the hand touches the object, and the parts of the hand that do, each once."""
        (rows,) = np.nonzero(self.contact_instants == instant)
        parts = dict.fromkeys(self.contact_parts[row] for row in rows.tolist())
        return self.contact_points[rows], tuple(parts)

    @property
    def object_rise_m(self) -> Float64[np.ndarray, "t"]:
        """How high the object's centre of mass is over where it was at first."""
        heights = self.T_world_object[:, 2, 3]
        rise: Float64[np.ndarray, "t"] = heights - heights[0]
        return rise

    @property
    def palm_rise_m(self) -> Float64[np.ndarray, "t"]:
        """How high the palm is over where it closed; NaN before."""
        heights = self.T_world_palm[:, 2, 3]
        before = np.array([phase in ("transit", "approach") for phase in self.phases])
        rise: Float64[np.ndarray, "t"] = np.where(before, np.nan, heights - heights[np.argmin(before)])
        return rise


_TEXTS = ("joint_names", "phases", "contact_parts")
_NUMBERS = tuple(entry.name for entry in fields(TrialRecording) if entry.name not in ("outcome", *_TEXTS))


def write_recording(path: str | Path, recording: TrialRecording) -> None:
    """Write a recording as a NumPy archive, atomically.

    Raises:
        InputError: if the place cannot be written to.
    """
    content: dict[str, Any] = {name: getattr(recording, name) for name in _NUMBERS}
    content |= {name: np.array(getattr(recording, name), dtype=np.str_) for name in ("outcome", *_TEXTS)}
    with atomic_path(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, format=np.array(FORMAT), **content)


def read_recording(path: str | Path) -> TrialRecording:
    """Read a recording; nothing in the file is unpickled.

    Raises:
        InputError: if the file is missing, damaged, or of another version.
    """
    again = "delete it; the simulator makes it again"
    try:
        with np.load(path, allow_pickle=False) as archive:
            content: dict[str, Any] = {name: archive[name] for name in archive.files}
        if str(content.pop("format", "")) != FORMAT:
            raise InputError(f"The file is no recording in the format {FORMAT}", where=path, fix=again)
        content |= {name: tuple(str(text) for text in content[name]) for name in _TEXTS}
        recording = TrialRecording(**content | {"outcome": TrialOutcome(str(content["outcome"]))})
    except FileNotFoundError as error:
        raise InputError("The recording does not exist", where=path, fix="check the path") from error
    except (OSError, EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"The recording is damaged ({error})", where=path, fix=again) from error
    by_instant = (recording.times_s, recording.phases, recording.joints, recording.T_world_object)
    if len({len(entry) for entry in by_instant}) != 1:
        raise InputError("The recording is damaged: its states do not match", where=path, fix=again)
    return recording
