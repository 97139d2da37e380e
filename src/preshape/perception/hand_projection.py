"""Where a hand appears in an image, as a differentiable function of theta."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.hands.kinematics import HandKinematics

NEAREST_M = 0.05
"""Points nearer to the camera, or behind it, project as if they were at this depth."""


class ProjectedHand(NamedTuple):
    """Palm and fingertips of b grasps in pixels (u, v) of their images.

    Args:
        palm: where the origin of the palm frame appears.
        fingertips: where the tips of the f fingers appear.
        direction: unit vector in which the palm's z axis, the direction of the middle finger, points there.
    """

    palm: Float[Tensor, "b 2"]
    fingertips: Float[Tensor, "b f 2"]
    direction: Float[Tensor, "b 2"]


class HandProjection(nn.Module):
    """Projects palm and fingertips of grasps by the hand's forward kinematics.

    Args:
        hand: kinematics of the hand; theta's palm pose is in the camera frame.
    """

    def __init__(self, hand: HandKinematics) -> None:
        super().__init__()
        self.hand = hand
        self.fingers = len(hand.origins)

    def forward(self, theta: Float[Tensor, "b d"], intrinsics: Float[Tensor, "#b 4"]) -> ProjectedHand:
        """Project b grasps.

        Args:
            theta: grasp configurations (camera frame, m and rad).
            intrinsics: fx, fy, cx, cy of each image, or of the one that all share (pixels).
        """
        palm = theta[:, None, :3]
        points = torch.cat((palm, self.hand.fingertips(theta)), dim=1)
        pixels = project(points, intrinsics)
        finger_axis = self.hand.palm_link_pose(theta)[:, :3, 2]
        direction = _image_direction(theta[:, :3], finger_axis, intrinsics)
        return ProjectedHand(pixels[:, 0], pixels[:, 1:], direction)


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
