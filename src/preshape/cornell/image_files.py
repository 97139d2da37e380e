"""The colour and range images of the data set."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, UInt8
from PIL import Image

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.text_files import damaged
from preshape.geometry.camera import Camera
from preshape.perception.view_files import BROKEN_IMAGE

RANGE_M = (0.2, 5.0)
"""Where a range image's median lies, and every depth that is known."""


def read_colour(path: Path) -> UInt8[np.ndarray, "h w 3"]:
    """Colours 0-255 of `pcdNNNNr.png`; raises InputError if it cannot be read or has another size."""
    return np.array(_read(path, "PNG").convert("RGB"))


def read_range(path: Path) -> Float32[np.ndarray, "h w"]:
    """Distances (m) from the robot's base of `pcdNNNNd.tiff`; other tools have filled its holes.

    Raises:
        InputError: if the file cannot be read, has another size, or holds no such distances.
    """
    image = _read(path, "TIFF")
    if image.mode != "F":
        raise damaged(path, f"it holds no 32-bit floating-point numbers (Pillow mode {image.mode})")
    distances = np.array(image, dtype=np.float32)
    if not np.isfinite(distances).all() or (distances < 0).any():
        raise damaged(path, "it holds something else than distances")
    median = float(np.median(distances))
    if not RANGE_M[0] <= median <= RANGE_M[1]:
        raise damaged(path, f"its median is {median:.3g} m, outside of {RANGE_M[0]:g}-{RANGE_M[1]:g} m")
    return distances


def depth_from_range(distances: Float32[np.ndarray, "h w"], camera: Camera) -> Float64[np.ndarray, "h w"]:
    """Depth (m) of the points at these distances (m) from the world's origin on the pixels' rays.

    A point on a ray d, with d_z = 1, has |t d - b| = r, where b is the origin in the camera's frame. Of the
    two depths t the farther one is taken: the nearer lies before the foot of the perpendicular from b, where
    no table is. NaN where the ray does not come so near to the origin, or outside of `RANGE_M`.
    """
    rotation, position = camera.T_world_camera[:3, :3], camera.T_world_camera[:3, 3]
    origin = -rotation.T @ position
    x, y = camera.rays()
    along = x * origin[0] + y * origin[1] + origin[2]
    square = x * x + y * y + 1
    with np.errstate(invalid="ignore"):
        root = np.sqrt(along**2 - square * (origin @ origin - distances.astype(np.float64) ** 2))
        depth: Float64[np.ndarray, "h w"] = (along + root) / square
        depth[~((depth >= RANGE_M[0]) & (depth <= RANGE_M[1]))] = np.nan
    return depth


def _read(path: Path, image_format: str) -> Image.Image:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # Pillow only warns of some truncated files
            with Image.open(path, formats=(image_format,)) as image:
                # compared before decoding, so that a small file cannot claim a lot of memory
                if image.size == (WIDTH, HEIGHT):
                    image.load()
                    return image
                size = image.size
    except (*BROKEN_IMAGE, UserWarning, KeyError, TypeError, OverflowError) as error:
        raise damaged(path, f"it is truncated or no {image_format} ({error})") from error
    raise damaged(path, f"it has {size[0]} x {size[1]} pixels, not {WIDTH} x {HEIGHT}")
