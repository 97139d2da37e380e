"""Forward kinematics of a hand as a differentiable function of theta."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from torch import Tensor, nn

from preshape.errors import InputError
from preshape.geometry.pose import rotation_from_euler_xyz
from preshape.hands.urdf_chain import Box, Joint, Urdf


class HandKinematics(nn.Module):
    """Where a hand in preshape theta has its palm and its fingers, in the frame of theta's palm pose.

    Everything is differentiable in theta, in the precision and on the device of theta. Joints that theta does
    not set are zero, as in the paper's preshape.

    Args:
        fingers: the joints of each finger from the palm link to the tip, equally many for each.
        preshape_joints: the joints that theta sets after its palm pose, in its order.
        palm_box: box around the palm.
        palm_offset_m: origin of theta's palm frame in the palm link, whose axes it shares.

    Raises:
        InputError: a preshape joint belongs to no finger, or the fingers differ in their number of joints.
    """

    origins: Float[Tensor, "f k 4 4"]
    cross: Float[Tensor, "f k 3 3"]
    theta_index: Int[Tensor, "f k"]
    offset: Float[Tensor, "3"]
    box_corners: Float[Tensor, "8 3"]

    def __init__(
        self,
        fingers: Sequence[Sequence[Joint]],
        preshape_joints: Sequence[str],
        palm_box: Box,
        palm_offset_m: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        super().__init__()
        _check_joints(fingers, preshape_joints)
        self.dim = 6 + len(preshape_joints)
        # Joints that theta does not set read a zero that is put after its end.
        index = {name: 6 + number for number, name in enumerate(preshape_joints)}
        self._keep("origins", [[joint.T_parent_child for joint in chain] for chain in fingers])
        self._keep("cross", [[_cross_matrix(joint.axis) for joint in chain] for chain in fingers])
        self._keep("theta_index", [[index.get(joint.name, self.dim) for joint in chain] for chain in fingers])
        self._keep("offset", np.asarray(palm_offset_m, dtype=np.float64))
        self._keep("box_corners", _corners(palm_box))

    def _keep(self, name: str, constant: ArrayLike) -> None:
        """Make a constant move between devices with the module, but not part of anyone's weights."""
        self.register_buffer(name, torch.tensor(np.array(constant)), persistent=False)

    @classmethod
    def from_urdf(
        cls,
        path: Path,
        *,
        palm_link: str,
        tip_links: Sequence[str],
        preshape_joints: Sequence[str],
        palm_offset_m: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> "HandKinematics":
        """Hand with one finger for each tip link of a URDF.

        Raises:
            InputError: the URDF cannot be read, or lacks what is asked of it.
        """
        urdf = Urdf(path)
        fingers = [urdf.chain(palm_link, tip) for tip in tip_links]
        return cls(fingers, preshape_joints, urdf.collision_box(palm_link), palm_offset_m)

    def palm_link_pose(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 4 4"]:
        """Pose of the palm link."""
        rotation = rotation_from_euler_xyz(theta[:, 3:6])
        position = theta[:, :3] - rotation @ self.offset.to(theta)
        top = torch.cat((rotation, position[..., None]), dim=-1)
        bottom = theta.new_tensor([0.0, 0.0, 0.0, 1.0]).expand(len(theta), 1, 4)
        return torch.cat((top, bottom), dim=-2)

    @property
    def fingers(self) -> int:
        """Number of fingers."""
        return len(self.origins)

    def palm(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 3"]:
        """Origin of theta's palm frame (m)."""
        return theta[:, :3]

    def direction(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 3"]:
        """The palm's z axis, the direction of the middle finger."""
        return self.palm_link_pose(theta)[:, :3, 2]

    def link_poses(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b f k 4 4"]:
        """Poses of the k links of each of the f fingers, the root first and the tip last."""
        origins, cross = self.origins.to(theta), self.cross.to(theta)
        angles = torch.cat((theta, theta.new_zeros(len(theta), 1)), dim=1)[:, self.theta_index, None, None]
        turns = torch.eye(3).to(theta) + angles.sin() * cross + (1 - angles.cos()) * cross @ cross
        pose = self.palm_link_pose(theta)[:, None]
        poses = []
        for k in range(origins.shape[1]):
            pose = pose @ origins[:, k]
            pose = torch.cat((pose[..., :3] @ turns[:, :, k], pose[..., 3:]), dim=-1)
            poses.append(pose)
        return torch.stack(poses, dim=2)

    def finger_points(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b f k 3"]:
        """Positions of the joints and the tip along each finger (m)."""
        return self.link_poses(theta)[..., :3, 3]

    def fingertips(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b f 3"]:
        """Positions of the fingertips (m)."""
        return self.finger_points(theta)[:, :, -1]

    def palm_corners(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 8 3"]:
        """Corners of the palm's box (m); the last four are those of its closing side, in a circle."""
        pose = self.palm_link_pose(theta)
        return self.box_corners.to(theta) @ pose[:, :3, :3].mT + pose[:, None, :3, 3]


def _check_joints(fingers: Sequence[Sequence[Joint]], preshape_joints: Sequence[str]) -> None:
    unknown = set(preshape_joints) - {joint.name for chain in fingers for joint in chain}
    if unknown or len({len(chain) for chain in fingers}) != 1:
        raise InputError(
            f"The hand's fingers have no joint {', '.join(sorted(unknown))}"
            if unknown
            else "The hand's fingers differ in their number of joints",
            where="preshape joints and tip links of the hand",
            fix="name joints and links of the hand's URDF",
        )


def _cross_matrix(axis: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Matrix K with K p = axis x p."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _corners(box: Box) -> Float[np.ndarray, "8 3"]:
    """Corners of a box in its link, first the four on its -x side and then those on its +x side."""
    circle = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    signs = np.array([(x, y, z) for x in (-1, 1) for y, z in circle])
    corners: Float[np.ndarray, "8 3"] = (
        signs * box.extents / 2 @ box.T_link_box[:3, :3].T + box.T_link_box[:3, 3]
    )
    return corners
