"""The box that a planner may not leave."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float64, Int

from preshape.grasps.space import GraspSpace


@runtime_checkable
class Box(Protocol):
    """How far a planner may go from an initial grasp."""

    def half_width(self, dim: int) -> Float64[np.ndarray, "{dim}"]:
        """Half width for each of the parameters; infinite where only the grasp space has limits."""
        ...


@dataclass(frozen=True)
class BoxSize:
    """Half widths of the box around the palm pose of an initial grasp.

    Args:
        position_m: for the palm's position. The paper's "0.1 m cube" is the full width.
        rotation_rad: for the palm's Euler angles. The paper's "0.3 rad" is the full width.
    """

    position_m: float = 0.05
    rotation_rad: float = 0.157

    def half_width(self, dim: int) -> Float64[np.ndarray, "{dim}"]:
        """See `Box`; joints are only limited by the robot."""
        half_width = np.full(dim, np.inf)
        half_width[:3], half_width[3:6] = self.position_m, self.rotation_rad
        return half_width


@dataclass(frozen=True)
class RectangleBox:
    """Half widths of the box around an initial rectangle; its opening is limited by the gripper alone.

    Args:
        centre_px: for both coordinates of the centre.
        angle_rad: for the angle. From pi / 2 on, every angle can be reached.
    """

    centre_px: float
    angle_rad: float

    def half_width(self, dim: int) -> Float64[np.ndarray, "{dim}"]:
        """See `Box`."""
        return np.array([self.centre_px, self.centre_px, self.angle_rad, np.inf])


@dataclass(frozen=True, eq=False)
class Bounds:
    """Limits of theta, one box for each start, in float64 and kept to the last bit.

    Args:
        lower, upper: limits; a parameter whose limits are equal is fixed.

    Raises:
        ValueError: if a lower limit is not at or below its upper limit.
    """

    lower: Float64[np.ndarray, "s d"]
    upper: Float64[np.ndarray, "s d"]

    def __post_init__(self) -> None:
        if not (self.lower <= self.upper).all():
            raise ValueError("a lower limit of the bounds lies above its upper limit")

    @classmethod
    def around(cls, initial: Float64[np.ndarray, "s d"], space: GraspSpace, size: Box) -> "Bounds":
        """The box around each initial grasp, within the limits of the grasp space."""
        half_width = size.half_width(space.dim)
        lower = np.maximum(initial - half_width, space.lower)
        return cls(lower, np.minimum(initial + half_width, space.upper))

    def __getitem__(self, rows: Int[np.ndarray, "m"]) -> "Bounds":
        """The boxes of some of the starts."""
        return Bounds(self.lower[rows], self.upper[rows])

    @property
    def half_width(self) -> Float64[np.ndarray, "s d"]:
        """Half widths of the boxes."""
        half_width: Float64[np.ndarray, "s d"] = (self.upper - self.lower) / 2
        return half_width

    @property
    def fixed(self) -> Bool[np.ndarray, "s d"]:
        """Which parameters cannot move at all."""
        fixed: Bool[np.ndarray, "s d"] = self.lower == self.upper
        return fixed

    def project(self, theta: Float64[np.ndarray, "*n s d"]) -> Float64[np.ndarray, "*n s d"]:
        """The nearest point inside each box."""
        inside: Float64[np.ndarray, "*n s d"] = np.clip(theta, self.lower, self.upper)
        return inside

    def drawn(self, count: int, seed: int) -> Float64[np.ndarray, "{count} s d"]:
        """Points that are evenly distributed in each box; the same seed draws the same ones."""
        uniform = np.random.default_rng(seed).random((count, *self.lower.shape))
        return self.project(self.lower + uniform * (self.upper - self.lower))

    def blocks(
        self, theta: Float64[np.ndarray, "s d"], direction: Float64[np.ndarray, "s d"]
    ) -> Bool[np.ndarray, "s d"]:
        """Which parameters stand at a limit that the direction would cross."""
        return ((theta >= self.upper) & (direction > 0)) | ((theta <= self.lower) & (direction < 0))
