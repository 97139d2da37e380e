"""What networks look at: object patches, and how the points of the camera frame appear in them."""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from preshape.geometry.camera import Camera
from preshape.perception.patch import PATCH_SIZE


class ViewBatch(NamedTuple):
    """Object patches of b views.

    Args:
        patch: the patches.
        intrinsics: fx, fy, cx, cy of the camera in the pixels of each patch, so that a point in the camera
            frame appears at u = fx x / z + cx, v = fy y / z + cy of the patch.
    """

    patch: Float[Tensor, "b 8 h w"]
    intrinsics: Float[Tensor, "b 4"]

    def to(self, target: Tensor | torch.device) -> "ViewBatch":
        """The same views on a device, or in the precision and on the device of another tensor."""
        return ViewBatch(self.patch.to(target), self.intrinsics.to(target))


def patch_intrinsics(
    camera: Camera, centre: tuple[float, float], size: int = PATCH_SIZE
) -> Float[np.ndarray, "4"]:
    """fx, fy, cx, cy of a camera in the pixels of the patch that `object_patch` cuts around a pixel."""
    left, top = (round(coordinate) - size // 2 for coordinate in centre)
    return np.array([camera.fx, camera.fy, camera.cx - left, camera.cy - top])
