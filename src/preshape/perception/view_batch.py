"""Views as the networks take them: tensors, several views at once."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from preshape.geometry.camera import Camera
from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.object_view import PATCH_SIZE, ObjectCloud


class ViewBatch(NamedTuple):
    """The object in b views.

    Args:
        patch: the object patches; without a pixel where the network does not look at them.
        intrinsics: fx, fy, cx, cy of the camera in the pixels of each patch, so that a point in the camera
            frame appears at u = fx x / z + cx, v = fy y / z + cy of the patch.
        points: points of each object's visible surface (camera frame, m).
        table: the table's plane in each camera frame: unit normal up, n . p + d is the height of p in m.
        T_camera_box: pose of each object's upright bounding box.
    """

    patch: Float[Tensor, "b 8 h w"]
    intrinsics: Float[Tensor, "b 4"]
    points: Float[Tensor, "b n 3"]
    table: Float[Tensor, "b 4"]
    T_camera_box: Float[Tensor, "b 4 4"]

    @classmethod
    def of(
        cls,
        clouds: Sequence[ObjectCloud],
        cameras: Sequence[Camera],
        patch: Float[Tensor, "b 8 h w"] | None = None,
    ) -> "ViewBatch":
        """Views in single precision; their patches may be in another.

        Args:
            clouds: where the objects are.
            cameras: the cameras that look at them.
            patch: the object patches; None for networks that do not look at them.
        """
        if patch is None:
            patch = torch.zeros(len(clouds), len(CHANNEL_NAMES), 0, 0)
        intrinsics = [
            patch_intrinsics(camera, cloud.centre(camera))
            for cloud, camera in zip(clouds, cameras, strict=True)
        ]
        points, table, T_camera_box = (
            torch.tensor(np.stack([getattr(cloud, name) for cloud in clouds]), dtype=torch.float32)
            for name in ("points", "table", "T_camera_box")
        )
        return cls(
            patch, torch.tensor(np.stack(intrinsics), dtype=torch.float32), points, table, T_camera_box
        )

    def to(self, target: Tensor | torch.device) -> "ViewBatch":
        """The same views on a device, or in the precision and on the device of another tensor."""
        return ViewBatch(*(part.to(target) for part in self))


def patch_intrinsics(
    camera: Camera, centre: tuple[float, float], size: int = PATCH_SIZE
) -> Float[np.ndarray, "4"]:
    """fx, fy, cx, cy of a camera in the pixels of the patch that `object_patch` cuts around a pixel."""
    left, top = (round(coordinate) - size // 2 for coordinate in centre)
    return np.array([camera.fx, camera.fy, camera.cx - left, camera.cy - top])
