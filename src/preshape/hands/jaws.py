"""The two jaws of a gripper whose grasp is a rectangle in the image."""

import torch
from jaxtyping import Float
from torch import Tensor


class Jaws:
    """Palm and fingertips of theta = (u, v, angle, opening) as points (u, v, 1) in the image.

    The palm is over the rectangle's centre and a fingertip over the middle of each jaw. Up is along the jaws,
    so that the opening is level in every patch. After half a turn the fingers have changed places and up is
    down: the same grasp, seen the other way round.
    """

    fingers = 2

    def palm(self, theta: Float[Tensor, "b 4"]) -> Float[Tensor, "b 3"]:
        """The rectangle's centre."""
        return torch.cat((theta[:, :2], torch.ones_like(theta[:, :1])), dim=1)

    def fingertips(self, theta: Float[Tensor, "b 4"]) -> Float[Tensor, "b 2 3"]:
        """The middles of both jaws."""
        angle, half = theta[:, 2], theta[:, 3] / 2
        offset = torch.stack((half * angle.cos(), half * angle.sin(), torch.zeros_like(half)), dim=1)
        centre = self.palm(theta)
        return torch.stack((centre - offset, centre + offset), dim=1)

    def direction(self, theta: Float[Tensor, "b 4"]) -> Float[Tensor, "b 3"]:
        """Along the jaws; for angle 0 that is up in the image."""
        angle = theta[:, 2]
        return torch.stack((angle.sin(), -angle.cos(), torch.zeros_like(angle)), dim=1)
