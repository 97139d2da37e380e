"""The space that a hand takes up, as spheres that move with theta."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float64, Int

from preshape.geometry.pose import transform_points
from preshape.hands.urdf_chain import Box, Joint, Urdf

OVERLAP = 1.2
"""Distance of neighbouring spheres in a box, as a multiple of their radius."""


class HandVolume:
    """Spheres that fill the collision shapes of a hand.

    The spheres of a box touch its faces from within, so that they reach every face and round off its edges.
    Planners ask for them at every step, for a few grasps at a time. Therefore positions and their derivatives
    are worked out here in NumPy: automatic differentiation of as many small products is ten times slower.

    Args:
        palm: spheres that move with the palm alone, (x, y, z, radius) in theta's palm frame (m).
        fingers: the joints of each finger from the palm link to the tip, the first with its pose in theta's
            palm frame.
        spheres: the spheres of each link of each finger, (x, y, z, radius) in the link (m).
        preshape_joints: the joints that theta sets after its palm pose, in its order; others are at zero.
    """

    def __init__(
        self,
        palm: Float[np.ndarray, "p 4"],
        fingers: Sequence[Sequence[Joint]],
        spheres: Sequence[Sequence[Float[np.ndarray, "_ 4"]]],
        preshape_joints: Sequence[str],
    ) -> None:
        self._dim = 6 + len(preshape_joints)
        index = {name: 6 + number for number, name in enumerate(preshape_joints)}
        parts = [
            _Chain.to_link(chain[: link + 1], index).carrying(found)
            for chain, links in zip(fingers, spheres, strict=True)
            for link, found in enumerate(links)
            if len(found)
        ]
        depth = max(len(part.matrices) for part, _ in parts)
        deep = [(part.deepened(depth, self._dim), found) for part, found in parts]
        counts = [len(found) for _, found in deep]
        self._palm = palm[:, :3]
        self._local = np.concatenate([found[:, :3] for _, found in deep])
        matrices = np.repeat(np.array([part.matrices for part, _ in deep]), counts, axis=0)
        levels = (len(matrices), depth)
        self._columns: Float[np.ndarray, "n l 9 3"] = matrices.reshape(*levels, 9, 3)
        # The same for the way back: of each of the three products the transpose.
        self._stacked: Float[np.ndarray, "n l 3 9"] = matrices.transpose(0, 1, 3, 2, 4).reshape(*levels, 3, 9)
        self._shifts = np.repeat(np.array([part.shifts for part, _ in deep]), counts, axis=0)
        self._index: Int[np.ndarray, "n l"] = np.repeat([part.index for part, _ in deep], counts, axis=0)
        self.radii = np.concatenate((palm[:, 3], *(found[:, 3] for _, found in deep)))
        """Radii of the k spheres (m): those of the palm first."""

    @classmethod
    def from_urdf(
        cls,
        path: Path,
        *,
        palm_link: str,
        tip_links: Sequence[str],
        preshape_joints: Sequence[str],
        palm_offset_m: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> "HandVolume":
        """Volume of the hand whose kinematics `HandKinematics.from_urdf` reads.

        Raises:
            InputError: the URDF cannot be read, or lacks what is asked of it.
        """
        urdf, offset = Urdf(path), np.asarray(palm_offset_m, dtype=np.float64)
        fingers, spheres = [], []
        for tip in tip_links:
            first, *others = urdf.chain(palm_link, tip)
            pose = first.T_parent_child.copy()
            pose[:3, 3] -= offset
            fingers.append([Joint(first.name, pose, first.axis), *others])
            spheres.append([_spheres_of(urdf.collision_boxes(link)) for link in urdf.links(palm_link, tip)])
        palm = _spheres_of(urdf.collision_boxes(palm_link))
        palm[:, :3] -= offset
        return cls(palm, fingers, spheres, preshape_joints)

    def in_palm(self, theta: Float64[np.ndarray, "s d"]) -> Float64[np.ndarray, "s k 3"]:
        """Centres of the k spheres in theta's palm frame (m), which depend on the joints alone."""
        points, _ = self._turned(theta)
        palm = np.broadcast_to(self._palm, (len(theta), *self._palm.shape))
        return np.concatenate((palm, points.transpose(2, 0, 1)), axis=1)

    def joint_gradient(
        self, theta: Float64[np.ndarray, "s d"], gradient: Float64[np.ndarray, "s k 3"]
    ) -> Float64[np.ndarray, "s d"]:
        """Gradient by the joints of a function whose gradient by the centres in the palm frame is given."""
        _, turns = self._turned(theta)
        total = np.zeros((self._dim + 1, len(theta)))
        flowing = np.ascontiguousarray(gradient[:, len(self._palm) :].transpose(1, 2, 0))
        for level, turn in enumerate(turns):
            by_angle = (flowing * turn.slope).sum(axis=1)
            np.add.at(total, self._index[:, level], by_angle)
            back = (self._stacked[:, level].swapaxes(1, 2) @ flowing).reshape(-1, 3, 3, len(theta))
            flowing = back[:, 0] + turn.sine * back[:, 1] + turn.versine * back[:, 2]
        return total[: self._dim].T.copy()

    def _turned(
        self, theta: Float64[np.ndarray, "s d"]
    ) -> tuple[Float64[np.ndarray, "n 3 s"], list["_Turn"]]:
        """Centres on the fingers, and the turns that brought them there, the one next to the palm first.

        The starts come last, so that a product takes them all at once.
        """
        angles = np.concatenate((theta.T, np.zeros((1, len(theta)))))
        sines, cosines = np.sin(angles)[self._index], np.cos(angles)[self._index]
        points = np.broadcast_to(self._local[..., None], (*self._local.shape, len(theta)))
        turns: list[_Turn] = []
        for level in reversed(range(self._index.shape[1])):
            sine, cosine = sines[:, level, None], cosines[:, level, None]
            # Rodrigues: a turn by q is 1 + sin q K + (1 - cos q) K^2, with K p = axis x p.
            products = (self._columns[:, level] @ points).reshape(-1, 3, 3, len(theta))
            turns.insert(0, _Turn(sine, 1 - cosine, cosine * products[:, 1] + sine * products[:, 2]))
            points = products[:, 0] + sine * products[:, 1] + (1 - cosine) * products[:, 2]
            points += self._shifts[:, level, :, None]
        return points, turns


@dataclass(frozen=True, eq=False)
class _Turn:
    """A joint of each sphere's chain: sine and 1 - cosine of its angle, and how that moves the sphere."""

    sine: Float64[np.ndarray, "n 1 s"]
    versine: Float64[np.ndarray, "n 1 s"]
    slope: Float64[np.ndarray, "n 3 s"]


class _Chain:
    """The turns that lead from the palm to a link: for each joint of theta F, F K and F K^2, and a shift.

    F is the rotation, and the shift the translation, from the frame of the joint before, through joints that
    stay at zero.
    """

    def __init__(self, index: Mapping[str, int]) -> None:
        self._theta_index = index
        self._pose = np.eye(4)
        self.matrices: list[Float[np.ndarray, "3 3 3"]] = []
        self.shifts: list[Float[np.ndarray, "3"]] = []
        self.index: list[int] = []

    @classmethod
    def to_link(cls, joints: Sequence[Joint], index: Mapping[str, int]) -> "_Chain":
        chain = cls(index)
        for joint in joints:
            chain._pose = chain._pose @ joint.T_parent_child
            if joint.name in index:
                x, y, z = joint.axis
                cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
                chain._append(index[joint.name], cross)
        return chain

    def _append(self, column: int, cross: Float[np.ndarray, "3 3"]) -> None:
        rotation = self._pose[:3, :3]
        self.matrices.append(np.stack((rotation, rotation @ cross, rotation @ cross @ cross)))
        self.shifts.append(self._pose[:3, 3])
        self.index.append(column)
        self._pose = np.eye(4)

    def carrying(self, spheres: Float[np.ndarray, "n 4"]) -> tuple["_Chain", Float[np.ndarray, "n 4"]]:
        """The chain, and spheres of its link in the frame of its last joint of theta."""
        placed = transform_points(self._pose, spheres[:, :3])
        return self, np.column_stack((placed, spheres[:, 3]))

    def deepened(self, depth: int, unmoved: int) -> "_Chain":
        """The chain with joints that do not turn at its end, so that all chains have equally many."""
        self._pose = np.eye(4)
        while len(self.matrices) < depth:
            self._append(unmoved, np.zeros((3, 3)))
        return self


def _spheres_of(boxes: Sequence[Box]) -> Float[np.ndarray, "n 4"]:
    """Spheres (x, y, z, radius) that fill boxes, in their link."""
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
