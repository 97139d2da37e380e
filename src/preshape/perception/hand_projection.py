"""Where a hand appears in an image, as a differentiable function of theta."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.hands.projectable import ProjectableHand
from preshape.perception.object_view import PATCH_SIZE

NEAREST_M = 0.05
"""Points nearer to the camera, or behind it, project as if they were at this depth."""


class ProjectedHand(NamedTuple):
    """Palm and fingertips of b grasps in pixels (u, v) of their images.

    Args:
        palm: where the origin of the palm frame appears.
        fingertips: where the tips of the f fingers appear.
        direction: unit vector in which the hand's direction points there: that of an Allegro hand's middle
            finger, or along the jaws of a gripper.
    """

    palm: Float[Tensor, "b 2"]
    fingertips: Float[Tensor, "b f 2"]
    direction: Float[Tensor, "b 2"]


class HandProjection(nn.Module):
    """Projects palm and fingertips of grasps by the hand's forward kinematics.

    Args:
        hand: where it has its palm and fingertips (camera frame).

    Attributes:
        view_size: height and width of the images in which they appear (pixels).
    """

    view_size = (PATCH_SIZE, PATCH_SIZE)

    def __init__(self, hand: ProjectableHand) -> None:
        super().__init__()
        self.hand = hand
        self.fingers = hand.fingers

    def forward(self, theta: Float[Tensor, "b d"], intrinsics: Float[Tensor, "#b 4"]) -> ProjectedHand:
        """Project b grasps.

        Args:
            theta: grasp configurations.
            intrinsics: fx, fy, cx, cy of each image, or of the one that all share (pixels).
        """
        palm = self.hand.palm(theta)
        points = torch.cat((palm[:, None], self.hand.fingertips(theta)), dim=1)
        pixels = project(points, intrinsics)
        direction = _image_direction(palm, self.hand.direction(theta), intrinsics)
        return ProjectedHand(pixels[:, 0], pixels[:, 1:], direction)


class RectangleProjection(HandProjection):
    """Projects grasps that are rectangles in the image already.

    Args:
        hand: where it has its palm and fingertips, as points (u, v, 1) in the image.
        step_px: pixels of the image along each pixel of its view.
        image_size: height and width of the image (pixels).
    """

    def __init__(
        self, hand: ProjectableHand, step_px: int = 1, image_size: tuple[int, int] = (480, 640)
    ) -> None:
        super().__init__(hand)
        self.step_px = step_px
        height, width = image_size
        self.view_size = (height // step_px, width // step_px)

    def forward(self, theta: Float[Tensor, "b d"], _: Float[Tensor, "#b 4"]) -> ProjectedHand:
        """Project b grasps; the camera does not matter."""
        scale = 1 / self.step_px
        # the centre of the image's first pixel is (0, 0), and so is that of the view's
        offset = (scale - 1) / 2
        return super().forward(theta, theta.new_tensor([[scale, scale, offset, offset]]))


def project(points: Float[Tensor, "b n 3"], intrinsics: Float[Tensor, "#b 4"]) -> Float[Tensor, "b n 2"]:
    """Pixel coordinates (u, v) of points in the camera frame (m)."""
    depth = points[..., 2:].clamp_min(NEAREST_M)
    focal, centre = intrinsics[:, None, :2], intrinsics[:, None, 2:]
    return focal * points[..., :2] / depth + centre


def _image_direction(
    point: Float[Tensor, "b 3"], axis: Float[Tensor, "b 3"], intrinsics: Float[Tensor, "#b 4"]
) -> Float[Tensor, "b 2"]:
    """Unit vector in which an axis through a point appears; up, (0, -1), if it lies along the ray."""
    along_ray = point[:, :2] / point[:, 2:].clamp_min(NEAREST_M)
    slope = intrinsics[:, :2] * (axis[:, :2] - along_ray * axis[:, 2:])
    length = torch.linalg.vector_norm(slope, dim=1, keepdim=True)
    tiny = length <= torch.finfo(slope.dtype).eps * intrinsics[:, :2].amax(dim=1, keepdim=True)
    up = slope.new_tensor([0.0, -1.0]).expand_as(slope)
    return torch.where(tiny, up, slope / length.masked_fill(tiny, 1.0))
