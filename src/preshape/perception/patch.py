"""Patches: fixed-size crops of the image around a pixel (paper, section 3.1)."""

import numpy as np
from jaxtyping import Float32

from preshape.geometry.camera import Camera
from preshape.perception.segmentation import SegmentedObject


def object_centre(segmented: SegmentedObject, camera: Camera) -> tuple[float, float]:
    """Pixel coordinates (u, v) to which the centre of the object's bounding box projects."""
    u, v = camera.project(segmented.T_camera_box[:3, 3])
    return float(u), float(v)


def object_patch(
    image: Float32[np.ndarray, "c h w"], centre: tuple[float, float], size: int = 400
) -> Float32[np.ndarray, "c size size"]:
    """Square crop of an image around a pixel, without resizing; 0 outside of the image.

    Args:
        image: channels first.
        centre: pixel coordinates (u, v); the nearest pixel lands at (size // 2, size // 2) of the patch.
        size: side of the patch in pixels.
    """
    patch = np.zeros((image.shape[0], size, size), dtype=np.float32)
    left, top = (round(coordinate) - size // 2 for coordinate in centre)
    height, width = image.shape[1:]
    rows = slice(np.clip(top, 0, height), np.clip(top + size, 0, height))
    columns = slice(np.clip(left, 0, width), np.clip(left + size, 0, width))
    crop = image[:, rows, columns]
    row, column = max(0, -top), max(0, -left)
    patch[:, row : row + crop.shape[1], column : column + crop.shape[2]] = crop
    return patch
