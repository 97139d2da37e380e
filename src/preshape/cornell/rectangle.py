"""A grasp of a two-finger gripper as a rectangle in the image (Jiang, Moseson, Saxena, ICRA 2011)."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class GraspRectangle:
    """Where the gripper closes, in pixels; the centre of the image's first pixel is (0, 0).

    Args:
        u, v: centre.
        angle_rad: from the image's u axis towards its v axis to the axis along which the gripper opens and
            closes. A gripper looks the same after half a turn, so it is kept within [0, pi).
        opening_px: how far the jaws are apart.
        jaw_px: width of the jaws.
    """

    u: float
    v: float
    angle_rad: float
    opening_px: float
    jaw_px: float

    def __post_init__(self) -> None:
        wrapped = self.angle_rad % math.pi
        # the remainder of a tiny negative number is rounded to pi itself
        object.__setattr__(self, "angle_rad", 0.0 if wrapped == math.pi else wrapped)

    @classmethod
    def from_corners(cls, corners: Float[np.ndarray, "4 2"]) -> "GraspRectangle":
        """The rectangle of four vertices (u, v) in either order round it, the first edge along the opening.

        Vertices that are not quite those of a rectangle are taken for the nearest; see `misfit_px`.
        """
        opening, jaw = _axes(corners)
        u, v = corners.mean(axis=0)
        angle = math.atan2(opening[1], opening[0])
        return cls(float(u), float(v), angle, math.hypot(*opening), math.hypot(*jaw))

    def corners(self) -> Float[np.ndarray, "4 2"]:
        """The vertices (u, v), clockwise on the screen, the first edge along the opening."""
        along = np.array([math.cos(self.angle_rad), math.sin(self.angle_rad)])
        across = np.array([-along[1], along[0]])
        opening, jaw = along * self.opening_px / 2, across * self.jaw_px / 2
        return np.array([self.u, self.v]) + np.stack(
            (-opening - jaw, opening - jaw, opening + jaw, jaw - opening)
        )

    def mirrored(self, width: int) -> "GraspRectangle":
        """The same grasp in the image with left and right exchanged.

        Args:
            width: of the image in pixels.
        """
        return GraspRectangle(width - 1 - self.u, self.v, -self.angle_rad, self.opening_px, self.jaw_px)


def misfit_px(corners: Float[np.ndarray, "4 2"]) -> float:
    """How far a vertex is at most from that of a rectangle; infinite if two of them coincide."""
    opening, jaw = _axes(corners)
    length = math.hypot(*opening)
    if not length or not jaw.any():
        return math.inf
    closing = corners[0] - corners[1] + corners[2] - corners[3]
    return math.hypot(*closing) / 4 + abs(float(opening @ jaw)) / length / 2


def _axes(corners: Float[np.ndarray, "4 2"]) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
    """Edges along the opening and along the jaws, each the mean of two."""
    p0, p1, p2, p3 = corners
    return (p1 - p0 + p2 - p3) / 2, (p2 - p1 + p3 - p0) / 2
