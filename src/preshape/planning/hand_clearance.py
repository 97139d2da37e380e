"""Where the hand may not be: in the table, in the object, and in either of them before it approaches."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from preshape.hands.volume import HandVolume
from preshape.perception.segmentation import SegmentedObject
from preshape.planning.constraint import Slack
from preshape.planning.object_solid import ObjectSolid, SolidSettings

FAR_M = 0.01
"""More slack from the object than this counts as this."""


@dataclass(frozen=True, eq=False)
class HandClearance:
    """Demands that keep the hand free of table and object, in the preshape and before the approach.

    The hand comes straight along the palm's normal, as in the simulator. That it is over the table at the
    beginning and at the end of this line keeps it over the table all along it.

    Args:
        hand: the space that the hand takes up.
        table_m: least distance of hand and wrist from the table.
        object_depth_m: how deep the hand may be in the object; depth is noisy, and what the camera does not
            see is guessed.
        pregrasp_m: least distance of the hand from the object where the approach begins.
        approach_m: length of the approach.
        wrist: what of the arm moves with the palm, as spheres (x, y, z, radius) in theta's palm frame (m).
        solid: how the object is made solid from one view.
    """

    hand: HandVolume
    table_m: float
    object_depth_m: float
    pregrasp_m: float
    approach_m: float
    wrist: Sequence[Sequence[float]] = ()
    solid: SolidSettings = field(default_factory=SolidSettings)

    def in_view(self, segmented: SegmentedObject) -> "ViewClearance":
        """The demands around the object of a view."""
        return ViewClearance(self, segmented)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Spheres of s hands: relative to the palm's origin, and to the camera, both along the camera's axes.

    The first `wrist` belong to the arm. The second half of all is the first half before the approach.
    """

    rotation: Float64[np.ndarray, "s 3 3"]
    relative: Float64[np.ndarray, "s k 3"]
    camera: Float64[np.ndarray, "s k 3"]


class ViewClearance:
    """The demands of a `HandClearance` around the object of one view: a `Constraint`."""

    def __init__(self, demands: HandClearance, segmented: SegmentedObject) -> None:
        self._hand = demands.hand
        self._solid = ObjectSolid(segmented, demands.solid)
        self._plane = segmented.plane
        wrist = np.array(demands.wrist, dtype=np.float64).reshape(-1, 4)
        self._wrist = wrist[:, :3]
        self._back = np.array([demands.approach_m, 0.0, 0.0])
        radii, hand_radii = np.concatenate((wrist[:, 3], self._hand.radii)), self._hand.radii
        self._demanded = np.concatenate(
            (
                np.tile(radii + demands.table_m, 2),
                hand_radii - demands.object_depth_m,
                hand_radii + demands.pregrasp_m,
            )
        )
        self._enough = self._demanded[2 * len(radii) :] + FAR_M
        halves = np.arange(2 * len(radii)).reshape(2, -1)
        self._own = halves[:, len(wrist) :].ravel()

    def slack(self, theta: Float64[np.ndarray, "s d"]) -> Slack:
        """Height of every sphere at the grasp and before the approach, then distances from the object."""
        placed = self._placed(theta)
        height = placed.camera @ self._plane[:3] + self._plane[3]
        distance = self._solid.distance(placed.camera[:, self._own], self._enough)
        values = np.concatenate((height, distance), axis=1) - self._demanded
        counting = np.ones(values.shape, dtype=bool)
        counting[:, height.shape[1] :] = distance < self._enough
        return Slack(values, lambda weights: self._pull_back(theta, placed, weights * counting))

    def _placed(self, theta: Float64[np.ndarray, "s d"]) -> _Placed:
        rotation = Rotation.from_euler("xyz", theta[:, 3:6]).as_matrix()
        wrist = np.broadcast_to(self._wrist, (len(theta), *self._wrist.shape))
        here = np.concatenate((wrist, self._hand.in_palm(theta)), axis=1)
        relative = np.concatenate((here, here - self._back), axis=1) @ rotation.swapaxes(1, 2)
        return _Placed(rotation, relative, relative + theta[:, None, :3])

    def _pull_back(
        self, theta: Float64[np.ndarray, "s d"], placed: _Placed, weights: Float64[np.ndarray, "s k"]
    ) -> Float64[np.ndarray, "s d"]:
        """Weights are forces on the spheres: their sum moves the palm, their torque turns it."""
        count = placed.camera.shape[1]
        force = weights[:, :count, None] * self._plane[:3]
        row, sphere = weights[:, count:].nonzero()
        own = self._own[sphere]
        direction = self._solid.gradient(placed.camera[row, own])
        force[row, own] += weights[row, count + sphere, None] * direction
        torque = np.cross(placed.relative, force).sum(axis=1)
        in_palm = force @ placed.rotation
        first, second = np.split(in_palm, 2, axis=1)
        gradient = self._hand.joint_gradient(theta, (first + second)[:, len(self._wrist) :])
        gradient[:, :3] = force.sum(axis=1)
        gradient[:, 3:6] = (_euler_axes(theta[:, 3:6]) @ torque[..., None])[..., 0]
        return gradient


def _euler_axes(angles: Float64[np.ndarray, "s 3"]) -> Float64[np.ndarray, "s 3 3"]:
    """About which axis each extrinsic XYZ Euler angle turns: one per row."""
    (_, cp, cy), (_, sp, sy) = np.cos(angles).T, np.sin(angles).T
    zero, one = np.zeros_like(cp), np.ones_like(cp)
    rows = ((cy * cp, sy * cp, -sp), (-sy, cy, zero), (zero, zero, one))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=1)
