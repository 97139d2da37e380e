"""Camera files: intrinsics, depth unit and pose of a camera as JSON."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.geometry.camera import Camera
from preshape.geometry.pose import is_pose

SIZES = ("width", "height")
INTRINSICS = ("fx", "fy", "cx", "cy")
MAX_PIXELS = 8192


@dataclass(frozen=True, eq=False)
class CameraFile:
    """What a camera file says.

    Args:
        camera: the camera; its pose is the identity if the file gives none.
        depth_scale_m: metres for one unit of the depth image.
        has_pose: whether the file gives the camera's pose.
    """

    camera: Camera
    depth_scale_m: float
    has_pose: bool


def read_camera(path: Path) -> CameraFile:
    """Read a camera file.

    Its keys are `width` and `height` (pixels), `fx`, `fy`, `cx` and `cy` (pixels; the centre of the first
    pixel is 0), `depth_scale_m` (metres for one unit of the depth image, 0.001 for a Kinect), and optionally
    `T_world_camera` (4 x 4, rows first: pose of the optical frame in a world whose z points up and whose x
    points from the robot to the table).

    Raises:
        InputError: the file is missing, is no JSON object, or one of its keys is unknown, missing or out of
            range.
    """
    content = read_json(path)
    unknown = set(content) - {*SIZES, *INTRINSICS, "depth_scale_m", "T_world_camera"}
    if unknown:
        raise _bad(path, f"has unknown keys: {', '.join(sorted(unknown))}")
    width, height = (_pixels(path, content, key) for key in SIZES)
    fx, fy, cx, cy = (_number(path, content, key, positive=key in ("fx", "fy")) for key in INTRINSICS)
    scale = _number(path, content, "depth_scale_m", positive=True)
    pose = _pose(path, content.get("T_world_camera", np.eye(4).tolist()))
    return CameraFile(Camera(width, height, fx, fy, cx, cy, pose), scale, "T_world_camera" in content)


def write_camera(path: Path, camera: Camera, depth_scale_m: float) -> None:
    """Write a camera file, with its pose.

    Raises:
        InputError: the place cannot be written to.
    """
    content = {key: getattr(camera, key) for key in (*SIZES, *INTRINSICS)}
    write_json(path, content | {"depth_scale_m": depth_scale_m, "T_world_camera": camera.T_world_camera})


def _bad(path: Path, what: str) -> InputError:
    return InputError(
        f"The camera file {what}",
        where=path,
        fix="give width, height, fx, fy, cx, cy, depth_scale_m and, if known, T_world_camera (4 x 4)",
    )


def _number(path: Path, content: Mapping[str, Any], key: str, *, positive: bool) -> float:
    if key not in content:
        raise _bad(path, f"lacks the key {key}")
    value = _finite(content[key])
    if value is None or (positive and value <= 0):
        raise _bad(path, f"needs a {'positive ' if positive else ''}number for {key}")
    return value


def _pixels(path: Path, content: Mapping[str, Any], key: str) -> int:
    value = _number(path, content, key, positive=True)
    if value != int(value) or value > MAX_PIXELS:
        raise _bad(path, f"needs a whole number up to {MAX_PIXELS} for {key}")
    return int(value)


def _pose(path: Path, value: Any) -> Float[np.ndarray, "4 4"]:
    rows = value if isinstance(value, list) else []
    numbers = [_finite(entry) for row in rows if isinstance(row, list) and len(row) == 4 for entry in row]
    if len(rows) == 4 and len(numbers) == 16 and None not in numbers:
        pose = np.array(numbers, dtype=np.float64).reshape(4, 4)
        if is_pose(pose):
            return pose
    raise _bad(path, "needs a rotation and a translation as 4 rows of 4 numbers for T_world_camera")


def _finite(value: Any) -> float | None:
    """The value as a finite float, if it is such a number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if np.isfinite(number) else None
