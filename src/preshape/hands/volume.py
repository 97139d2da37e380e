"""The space that a hand takes up, as spheres that move with theta."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from preshape.geometry.pose import transform_points
from preshape.hands.kinematics import HandKinematics
from preshape.hands.urdf_chain import Box, Urdf

OVERLAP = 1.2
"""Distance of neighbouring spheres in a box, as a multiple of their radius."""


class HandVolume(nn.Module):
    """Spheres that fill the collision shapes of a hand, in the frame of theta's palm pose.

    The spheres of a box touch its faces from within, so that they reach every face and round off its edges.

    Args:
        kinematics: where the links are.
        palm: spheres of the palm link, (x, y, z, radius) in that link (m).
        fingers: the spheres of each link of each finger, (x, y, z, radius) in the link (m); finger f, link k
            as in `HandKinematics.link_poses`.
        attached: further spheres that move with the palm link, such as the wrist that carries the hand.

    Attributes:
        attached: how many of the spheres, the first ones, are not the hand's own.
    """

    palm: Float[Tensor, "p 4"]
    links: Float[Tensor, "n 4"]
    link_index: Int[Tensor, "n"]

    def __init__(
        self,
        kinematics: HandKinematics,
        palm: Float[np.ndarray, "p 4"],
        fingers: Sequence[Sequence[Float[np.ndarray, "_ 4"]]],
        attached: Float[np.ndarray, "a 4"],
    ) -> None:
        super().__init__()
        self.kinematics = kinematics
        self.attached = len(attached)
        palm = np.concatenate((attached, palm))
        links = [spheres for finger in fingers for spheres in finger]
        owner = np.repeat(np.arange(len(links)), [len(spheres) for spheres in links])
        self.register_buffer("palm", torch.from_numpy(palm), persistent=False)
        self.register_buffer("links", torch.from_numpy(np.concatenate(links)), persistent=False)
        self.register_buffer("link_index", torch.from_numpy(owner), persistent=False)

    @classmethod
    def from_urdf(
        cls,
        path: Path,
        kinematics: HandKinematics,
        *,
        palm_link: str,
        tip_links: Sequence[str],
        attached: Sequence[Sequence[float]] = (),
    ) -> "HandVolume":
        """Volume of the hand whose kinematics come from the same file and links.

        Args:
            path: the URDF.
            kinematics: the hand's kinematics.
            palm_link, tip_links: as for `HandKinematics.from_urdf`.
            attached: further spheres that move with the palm link, (x, y, z, radius) in it (m).

        Raises:
            InputError: the URDF cannot be read, or lacks what is asked of it.
        """
        urdf = Urdf(path)
        fingers = [
            [_spheres_of(urdf.collision_boxes(link)) for link in urdf.links(palm_link, tip)]
            for tip in tip_links
        ]
        palm = _spheres_of(urdf.collision_boxes(palm_link))
        return cls(kinematics, palm, fingers, np.array(attached, dtype=np.float64).reshape(-1, 4))

    @property
    def radii(self) -> Float[Tensor, "k"]:
        """Radii of the k spheres (m), in the order of `centres`: what is attached, the palm, the fingers."""
        return torch.cat((self.palm[:, 3], self.links[:, 3]))

    def centres(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b k 3"]:
        """Centres of the k spheres (m), differentiable in theta."""
        palm, links = self.kinematics.palm_link_pose(theta), self.kinematics.link_poses(theta)
        carriers = links.flatten(1, 2)[:, self.link_index]
        on_links = (carriers[..., :3, :3] @ self.links[:, :3, None].to(theta))[..., 0] + carriers[..., :3, 3]
        on_palm = self.palm[:, :3].to(theta) @ palm[:, :3, :3].mT + palm[:, None, :3, 3]
        return torch.cat((on_palm, on_links), dim=1)


def _spheres_of(boxes: Sequence[Box]) -> Float[np.ndarray, "n 4"]:
    """Spheres (x, y, z, radius) that fill rounded boxes, in their link."""
    return np.concatenate([np.zeros((0, 4)), *(_spheres_in(box) for box in boxes)])


def _spheres_in(box: Box) -> Float[np.ndarray, "n 4"]:
    half = box.extents / 2
    radius = half.min()
    span = half - radius
    counts = 1 + np.ceil(2 * span / (OVERLAP * radius) - 1e-9).astype(int)
    axes = [np.linspace(-s, s, n) if n > 1 else np.zeros(1) for s, n in zip(span, counts, strict=True)]
    centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    placed = transform_points(box.T_link_box, centres)
    return np.column_stack((placed, np.full(len(placed), radius)))
