"""The room that an object takes up, as far as one view shows it."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float64
from scipy import ndimage
from torch import Tensor
from torch.nn.functional import grid_sample

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
        self._voxel_m = settings.voxel_m
        T_box_camera = invert_pose(segmented.T_camera_box)
        filled = _columns(transform_points(T_box_camera, segmented.points), segmented.extents, settings)
        distance = _signed_distance(filled, settings.voxel_m).astype(np.float32)
        # `grid_sample` wants the last coordinate first.
        self._field = torch.from_numpy(distance)[None, None]
        cells = np.array(filled.shape)
        half = settings.voxel_m * (cells - 1) / 2
        # The voxels stand on the table and are centred on the box.
        middle = np.array([0.0, 0.0, (cells[2] * settings.voxel_m - segmented.extents[2]) / 2])
        self._rotation = torch.from_numpy(T_box_camera[:3, :3])
        self._shift = torch.from_numpy(T_box_camera[:3, 3] - middle)
        self._half = torch.from_numpy(half)

    def distance(self, points: Float64[Tensor, "b k 3"]) -> Float64[Tensor, "b k"]:
        """Signed distance (m) of points in the camera frame, negative inside; differentiable."""
        grid = ((points @ self._rotation.T + self._shift) / self._half).float().flip(-1)
        sampled = grid_sample(
            self._field, grid[None, None], mode="bilinear", padding_mode="border", align_corners=True
        )
        return sampled[0, 0, 0].double()


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
