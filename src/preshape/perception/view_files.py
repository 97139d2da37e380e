"""Saved RGB-D views: a colour PNG, a 16-bit depth PNG and a camera file."""

import dataclasses
import logging
import struct
import zlib
from pathlib import Path
from tokenize import TokenError

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.perception.camera_files import CameraFile, read_camera, write_camera
from preshape.perception.observation import Observation
from preshape.perception.table import camera_pose_over_table

RGB_NAME, DEPTH_NAME, CAMERA_NAME = "rgb.png", "depth.png", "camera.json"
DEPTH_RANGE_M = (0.2, 5.0)
MILLIMETRE = 0.001
# What Pillow raises for a file that is no image, or a broken one.
BROKEN_IMAGE = (
    OSError,
    SyntaxError,
    ValueError,
    EOFError,
    struct.error,
    zlib.error,
    Image.DecompressionBombError,
)

logger = logging.getLogger(__name__)


def load_view(rgb: str | Path, depth: str | Path, camera: str | Path) -> Observation:
    """Read a view from its three files.

    Without a camera pose, the table is taken for the world's horizontal plane and the image's right for the
    direction away from the robot.

    Args:
        rgb: colour image, PNG or JPEG.
        depth: 16-bit grey PNG in units of the camera file's `depth_scale_m`, or a NumPy file (`.npy`), whose
            floats are metres and whose integers are such units; 0 or NaN where the sensor saw nothing.
        camera: camera file, see `read_camera`.

    Raises:
        InputError: a file is missing, truncated or of the wrong kind; sizes differ; the depth's median is
            outside of 0.2-5 m; or no pose is given and no table is in view.
    """
    file = read_camera(Path(camera))
    colour = _read_colour(Path(rgb), file)
    metres = _read_depth(Path(depth), file)
    if not file.has_pose:
        logger.warning("%s gives no T_world_camera: taking it from the table in view", camera)
        points = file.camera.unproject(metres.astype(np.float64))
        pose = camera_pose_over_table(points)
        file = dataclasses.replace(file, camera=dataclasses.replace(file.camera, T_world_camera=pose))
    return Observation(colour, metres, None, file.camera)


def save_view(folder: str | Path, observation: Observation) -> None:
    """Write a view to `rgb.png`, `depth.png` (in millimetres) and `camera.json` in a folder.

    Raises:
        InputError: the place cannot be written to.
    """
    folder = Path(folder)
    units = np.round(np.nan_to_num(observation.depth) / MILLIMETRE)
    units[units > np.iinfo(np.uint16).max] = 0
    with atomic_path(folder / RGB_NAME) as path:
        Image.fromarray(observation.rgb).save(path)
    with atomic_path(folder / DEPTH_NAME) as path:
        Image.fromarray(units.astype(np.uint16)).save(path)
    write_camera(folder / CAMERA_NAME, observation.camera, MILLIMETRE)


def _read_colour(path: Path, file: CameraFile) -> UInt8[np.ndarray, "h w 3"]:
    image = _open_image(path, file, formats=("PNG", "JPEG"))
    if image.mode.startswith(("I", "F")):
        raise InputError(
            f"The colour image has no colours (Pillow mode {image.mode})",
            where=path,
            fix="give the 8-bit RGB image; colour and depth may be swapped",
        )
    return np.array(image.convert("RGB"))


def _read_depth(path: Path, file: CameraFile) -> Float32[np.ndarray, "h w"]:
    values = _read_array(path, file) if path.suffix == ".npy" else np.array(_open_depth(path, file))
    in_metres = np.issubdtype(values.dtype, np.floating)
    metres = values.astype(np.float32) * np.float32(1.0 if in_metres else file.depth_scale_m)
    known = (metres > 0) & np.isfinite(metres)
    low, high = DEPTH_RANGE_M
    median = float(np.median(metres[known])) if known.any() else 0.0
    if not low <= median <= high:
        unit = (
            "numbers with a fraction are metres" if in_metres else f"depth_scale_m is {file.depth_scale_m:g}"
        )
        raise InputError(
            f"The depth image's median is {median:.3g} m, outside of {low:g}-{high:g} m"
            if known.any()
            else "The depth image is empty: the sensor saw nothing",
            where=path,
            fix=f"check the depth's unit: {unit}; save millimetres as integers with depth_scale_m 0.001",
        )
    return np.where(known, metres, np.float32(np.nan))


def _open_depth(path: Path, file: CameraFile) -> Image.Image:
    image = _open_image(path, file, formats=("PNG",))
    if not image.mode.startswith("I"):
        raise InputError(
            f"The depth image is not 16-bit grey (Pillow mode {image.mode})",
            where=path,
            fix="save raw depth as a 16-bit PNG, not a picture of it; colour and depth may be swapped",
        )
    return image


def _read_array(path: Path, file: CameraFile) -> np.ndarray:
    """Depth from a NumPy file, of the size that the camera file gives."""
    expected = (file.camera.height, file.camera.width)
    try:
        # Mapped, so that a file cannot claim memory before its size is compared; pickles are refused.
        values = np.load(path, mmap_mode="r", allow_pickle=False)
    except FileNotFoundError as error:
        raise InputError("The depth file does not exist", where=path, fix="check the path") from error
    except (OSError, ValueError, EOFError, SyntaxError, TokenError) as error:  # a damaged head is parsed
        raise InputError(
            f"The depth file cannot be read: it is no array of numbers ({error})",
            where=path,
            fix="save it with numpy.save as a plain array",
        ) from error
    if values.shape != expected or values.dtype.kind not in "uif":
        raise InputError(
            f"The depth file holds {values.dtype} of shape {values.shape}, not numbers of shape {expected}",
            where=path,
            fix="give colour, depth and camera file of the same view, the depth registered to the colour",
        )
    return np.array(values)


def _open_image(path: Path, file: CameraFile, formats: tuple[str, ...]) -> Image.Image:
    """Decoded image of the size that the camera file gives."""
    expected = (file.camera.width, file.camera.height)
    try:
        with Image.open(path, formats=formats) as image:
            # Compared before decoding, so that a small file cannot claim a lot of memory.
            if image.size == expected:
                image.load()
                return image
            size = image.size
    except FileNotFoundError as error:
        raise InputError("The image does not exist", where=path, fix="check the path") from error
    except BROKEN_IMAGE as error:
        raise InputError(
            f"The image cannot be read: it is truncated, damaged or not {' or '.join(formats)} ({error})",
            where=path,
            fix="save or copy it again",
        ) from error
    raise InputError(
        f"The image has {size[0]} x {size[1]} pixels, but the camera {expected[0]} x {expected[1]}",
        where=path,
        fix="give colour, depth and camera file of the same view, the depth registered to the colour",
    )
