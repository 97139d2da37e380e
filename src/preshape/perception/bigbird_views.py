"""Captures of the BigBIRD data set as RGB-D views."""

import logging
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Num
from PIL import Image
from scipy.ndimage import map_coordinates

from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.perception.bigbird_calibration import (
    CALIBRATION,
    BigbirdSensor,
    pose_file,
    read_bigbird_sensor,
)
from preshape.perception.bigbird_layout import ORIGIN, bigbird_file
from preshape.perception.depth_registration import registered_depth
from preshape.perception.hdf5_files import read_hdf5
from preshape.perception.observation import Observation
from preshape.perception.view_files import BROKEN_IMAGE

SENSORS = range(1, 6)
ANGLES = range(0, 360, 3)

log = logging.getLogger(__name__)


def load_bigbird_view(folder: str | Path, sensor: int, angle: int, width: int = 640) -> Observation:
    """One capture of an object: what sensor NP`sensor` saw when the turntable stood at `angle`.

    The view is the colour camera's: its image is shrunk and freed of the lens's distortion, and the depth,
    which the infrared camera beside it measured, is registered to it (see `registered_depth`). The world is
    the turntable's frame: z = 0 is its top, z points up, and it turns with the object (see
    `read_bigbird_sensor`).

    Args:
        folder: the object's folder. Its files lie in it as the authors of the data set name them, or under
            `processed` in it.
        sensor: 1 to 5; 5 looks down from above.
        angle: 0 to 357 degrees in steps of 3.
        width: of the view (pixels), at most that of the colour image; the height keeps its proportions.

    Returns:
        The view. Its mask is that of the data set, where the object is the value that fewer pixels have;
        None if there is no mask, or only one value in it.

    Raises:
        InputError: there is no such capture, or a file of it is missing, truncated or damaged.
    """
    folder, name = Path(folder), f"NP{sensor}"
    paths = {key: bigbird_file(folder, f"{name}_{angle}.{key}") for key in ("jpg", "h5")}
    _check_capture(folder, sensor, angle, [*paths.values(), bigbird_file(folder, CALIBRATION)])
    calibration = read_bigbird_sensor(folder, name, angle)
    picture = _read_image(paths["jpg"], "JPEG")
    if not 1 <= width <= picture.width:
        raise InputError(
            f"The view cannot be {width} pixels wide",
            where=paths["jpg"],
            fix=f"choose a width of up to {picture.width} pixels, that of the image",
        )
    size = (width, max(1, round(picture.height * width / picture.width)))
    camera = calibration.rgb_camera(size, picture.size)
    shrunk = np.asarray(picture.convert("RGB").resize(size, Image.Resampling.BOX), dtype=np.float64)
    channels = [_without_distortion(shrunk[..., number], calibration, camera, order=1) for number in range(3)]
    rgb = np.rint(np.stack(channels, axis=-1)).astype(np.uint8)
    depth = _read_depth(paths["h5"], calibration.depth_unit_m)
    seen = registered_depth(depth, calibration.depth_camera((depth.shape[1], depth.shape[0])), camera)
    mask = _read_mask(bigbird_file(folder, f"masks/{name}_{angle}_mask.pbm"), picture.size, size)
    if mask is not None:
        mask = _without_distortion(mask.astype(np.uint8), calibration, camera, order=0) > 0
    return Observation(rgb, seen, mask, camera)


def _check_capture(folder: Path, sensor: int, angle: int, needed: list[Path]) -> None:
    if sensor not in SENSORS or angle not in ANGLES:
        raise InputError(
            f"BigBIRD has no capture of sensor {sensor} at {angle} degrees",
            where=folder,
            fix="choose a sensor of 1 to 5, and an angle of 0 to 357 that is a multiple of 3",
        )
    if not folder.is_dir():
        raise InputError("The object's folder does not exist", where=folder, fix=f"check the path. {ORIGIN}")
    missing = [
        str(path.relative_to(folder)) for path in (*needed, pose_file(folder, angle)) if not path.is_file()
    ]
    if missing:
        raise InputError(
            f"The capture NP{sensor}_{angle} is not complete: it lacks {', '.join(missing)}",
            where=folder,
            fix=f"extract all archives of the object there. {ORIGIN}",
        )


def _read_depth(path: Path, unit_m: float) -> Float[np.ndarray, "h w"]:
    """Depth image (m) as the sensor measured it; NaN where it saw nothing."""
    units = read_hdf5(path, {"depth": (None, None)})["depth"].astype(np.float64)
    return np.where(units > 0, units * unit_m, np.nan)


def _read_mask(
    path: Path, full_size: tuple[int, int], size: tuple[int, int]
) -> Bool[np.ndarray, "h w"] | None:
    """The object's pixels; None if the data set does not know them."""
    if not path.is_file():
        log.info("%s is missing: the view gets no mask", path)
        return None
    image = _read_image(path, "PPM").convert("L")
    if image.size != full_size:
        raise InputError(
            "The mask has {} x {} pixels, but the image {} x {}".format(*image.size, *full_size),
            where=path,
            fix="extract it again; masks and images are of the same object and sensor",
        )
    bright = np.asarray(image) > 127
    if bright.all() or not bright.any():
        log.info("%s shows no object: the view gets no mask", path)
        return None
    mask = bright if 2 * np.count_nonzero(bright) < bright.size else ~bright
    return np.asarray(Image.fromarray(mask).resize(size, Image.Resampling.NEAREST))


def _without_distortion(
    image: Num[np.ndarray, "h w"], sensor: BigbirdSensor, camera: Camera, order: int
) -> Num[np.ndarray, "h w"]:
    """An image as a pinhole camera with the same intrinsics would see it; 0 beyond its borders.

    Args:
        image: of the size of `camera`.
        sensor: what distorted it.
        camera: the pinhole camera.
        order: of the interpolation: 0 takes the nearest pixel, 1 is linear.
    """
    x, y = np.broadcast_arrays(*camera.rays())
    u, v = camera.project(np.stack((*sensor.distorted(x, y), np.ones_like(x)), axis=-1))
    return np.asarray(map_coordinates(image, (v, u), order=order, mode="grid-constant", cval=0))


def _read_image(path: Path, image_format: str) -> Image.Image:
    try:
        with Image.open(path, formats=(image_format,)) as image:
            image.load()
            return image
    except BROKEN_IMAGE as error:
        raise InputError(
            f"The image cannot be read: it is truncated, damaged or not {image_format} ({error})",
            where=path,
            fix="extract or download it again",
        ) from error
