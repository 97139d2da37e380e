"""What networks are shown of a view: the patch around the object (paper, section 3.1) and its points."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Float32

from preshape.geometry.camera import Camera
from preshape.perception.image import CHANNEL_NAMES, eight_channel_image
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentedObject
from preshape.perception.surface import REACH_PX

PATCH_SIZE = 400
"""Width and height of an object patch in pixels."""
CLOUD_SIZE = 512
"""Number of points in an object's cloud."""
CLOUD_SEED = 0


@dataclass(frozen=True, eq=False)
class ObjectCloud:
    """Where the object is, in the camera frame.

    Args:
        points: points of the object's visible surface (m), in random order, so that any part of them is a
            fair sample; an object of fewer pixels repeats some.
        table: the table's plane (a, b, c, d): unit normal up, n . p + d is the height of p over the table.
        T_camera_box: pose of the object's bounding box, around whose centre the patch lies.
    """

    points: Float32[np.ndarray, "512 3"]
    table: Float[np.ndarray, "4"]
    T_camera_box: Float[np.ndarray, "4 4"]

    def centre(self, camera: Camera) -> tuple[float, float]:
        """Pixel coordinates (u, v) to which the centre of the object's bounding box projects."""
        u, v = camera.project(self.T_camera_box[:3, 3])
        return float(u), float(v)


def object_cloud(segmented: SegmentedObject) -> ObjectCloud:
    """A random sample of an object's points; the same object gives the same sample."""
    order = np.random.default_rng(CLOUD_SEED).permutation(len(segmented.points))
    points = segmented.points[np.resize(order, CLOUD_SIZE)].astype(np.float32)
    return ObjectCloud(points, segmented.plane, segmented.T_camera_box)


def object_patch(
    observation: Observation, centre: tuple[float, float], size: int = PATCH_SIZE
) -> Float32[np.ndarray, "8 size size"]:
    """Square crop of the 8-channel image around a pixel, without resizing; 0 outside of the view.

    Args:
        observation: the view.
        centre: pixel coordinates (u, v); the nearest pixel lands at (size // 2, size // 2) of the patch.
        size: side of the patch in pixels.
    """
    # The channels cost time, so they are made for the patch alone, and for what its outermost pixels look at.
    wide = np.zeros((len(CHANNEL_NAMES), size + 2 * REACH_PX, size + 2 * REACH_PX), dtype=np.float32)
    left, top = (round(coordinate) - size // 2 - REACH_PX for coordinate in centre)
    height, width = observation.depth.shape
    rows = slice(*np.clip((top, top + wide.shape[1]), 0, height).tolist())
    columns = slice(*np.clip((left, left + wide.shape[2]), 0, width).tolist())
    if rows.start < rows.stop and columns.start < columns.stop:
        seen = np.s_[:, rows.start - top : rows.stop - top, columns.start - left : columns.stop - left]
        wide[seen] = eight_channel_image(_window(observation, rows, columns))
    return np.ascontiguousarray(wide[:, REACH_PX:-REACH_PX, REACH_PX:-REACH_PX])


def _window(observation: Observation, rows: slice, columns: slice) -> Observation:
    """Some rows and columns of a view as a view of their own."""
    camera = observation.camera
    cut = replace(
        camera,
        width=columns.stop - columns.start,
        height=rows.stop - rows.start,
        cx=camera.cx - columns.start,
        cy=camera.cy - rows.start,
    )
    mask = None if observation.mask is None else observation.mask[rows, columns]
    return Observation(observation.rgb[rows, columns], observation.depth[rows, columns], mask, cut)
