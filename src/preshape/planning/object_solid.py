"""The room that an object takes up, as far as one view shows it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64
from scipy import ndimage

from preshape.geometry.pose import invert_pose, transform_points
from preshape.perception.segmentation import SegmentedObject


@dataclass(frozen=True)
class SolidSettings:
    """How an object is made solid.

    Args:
        voxel_m: edge of the voxels.
        padding_m: distances are known up to so far from the object; farther away they count as this.
    """

    voxel_m: float = 0.006
    padding_m: float = 0.04


class ObjectSolid:
    """Signed distances from an object that is solid between what the camera sees of it and the table.

    The camera sees one side. The object is taken to fill the columns under its visible points, as one that
    was put on a table mostly does, so that its hidden back counts too.

    Args:
        segmented: the object.
        settings: voxels.
    """

    def __init__(self, segmented: SegmentedObject, settings: SolidSettings) -> None:
        T_box_camera = invert_pose(segmented.T_camera_box)
        filled = _columns(transform_points(T_box_camera, segmented.points), segmented.extents, settings)
        self._field = _signed_distance(filled, settings.voxel_m).ravel()
        self._voxel_m = settings.voxel_m
        self._top = np.array(filled.shape) - 1.0
        self._last = np.array(filled.shape) - 2
        # The voxels stand on the table and are centred on the box.
        low = -settings.voxel_m * self._top / 2
        low[2] = settings.voxel_m / 2 - segmented.extents[2] / 2
        self._rotation = T_box_camera[:3, :3] / settings.voxel_m
        self._shift = (T_box_camera[:3, 3] - low) / settings.voxel_m
        corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(8, 3)
        self._strides = np.array([filled.shape[1] * filled.shape[2], filled.shape[2], 1])
        self._corners = corners @ self._strides

    def distance(
        self, points: Float64[np.ndarray, "s k 3"], enough_m: Float64[np.ndarray, "k"]
    ) -> Float64[np.ndarray, "s k"]:
        """Signed distance (m) of points in the camera frame, negative inside, up to what is enough.

        Args:
            points: the points.
            enough_m: distances beyond count as this; for most points the nearest voxel tells so already.
        """
        place = np.clip(points @ self._rotation.T + self._shift, 0.0, self._top)
        at_voxel = self._field[np.rint(place).astype(np.intp) @ self._strides]
        # To the nearest voxel it is at most half the diagonal of one.
        near = at_voxel < enough_m + np.sqrt(3) / 2 * self._voxel_m
        place = place[near]
        first = np.minimum(place.astype(np.intp), self._last)
        values = self._field[(first @ self._strides)[:, None] + self._corners]
        part = place - first
        for axis in range(3):
            half = values.shape[1] // 2
            values = values[:, :half] + part[:, axis, None] * (values[:, half:] - values[:, :half])
        found = np.broadcast_to(enough_m, near.shape).copy()
        found[near] = np.minimum(values[:, 0], found[near])
        return found

    def gradient(self, points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
        """Gradient of the distance, in the camera frame; zero along axes on which a point is far away."""
        free = points @ self._rotation.T + self._shift
        place = np.clip(free, 0.0, self._top)
        first = np.minimum(place.astype(np.intp), self._last)
        cube = self._field[(first @ self._strides)[:, None] + self._corners].reshape(-1, 2, 2, 2)
        x, y, z = np.stack((1 - (place - first), place - first)).transpose(2, 1, 0)
        slope = np.array([-1.0, 1.0])
        by_cell = np.stack(
            (
                np.einsum("nijk,i,nj,nk->n", cube, slope, y, z),
                np.einsum("nijk,ni,j,nk->n", cube, x, slope, z),
                np.einsum("nijk,ni,nj,k->n", cube, x, y, slope),
            ),
            axis=1,
        )
        gradient: Float64[np.ndarray, "n 3"] = (by_cell * (free == place)) @ self._rotation
        return gradient


def _columns(
    points: Float[np.ndarray, "n 3"], extents: Float[np.ndarray, "3"], settings: SolidSettings
) -> Bool[np.ndarray, "x y z"]:
    """Voxels under the visible points, with empty ones around.

    Args:
        points: the object's points in the frame of its box.
        extents: lengths of the box.
        settings: voxels.
    """
    voxel_m = settings.voxel_m
    padding = round(settings.padding_m / voxel_m)
    cells = np.ceil(extents / voxel_m).astype(int)
    top = np.zeros(tuple(cells[:2]))
    place = np.clip(np.floor(points[:, :2] / voxel_m + cells[:2] / 2).astype(int), 0, cells[:2] - 1)
    np.maximum.at(top, tuple(place.T), points[:, 2] + extents[2] / 2)
    # Columns between seen ones, from which no point came back.
    top = ndimage.grey_closing(np.pad(top, padding), size=3)
    heights = (np.arange(cells[2] + padding) + 0.5) * voxel_m
    filled: Bool[np.ndarray, "x y z"] = heights < top[..., None]
    return filled


def _signed_distance(filled: Bool[np.ndarray, "x y z"], voxel_m: float) -> Float[np.ndarray, "x y z"]:
    """Distance (m) of the voxels' centres from the surface of the filled ones, negative inside."""
    outside = ndimage.distance_transform_edt(~filled)
    inside = ndimage.distance_transform_edt(filled)
    distance: Float[np.ndarray, "x y z"] = voxel_m * np.where(filled, 0.5 - inside, outside - 0.5)
    return distance
