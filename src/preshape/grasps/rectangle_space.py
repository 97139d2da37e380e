"""The grasp space of a two-finger gripper: a rectangle in the image, four numbers (paper, section 4.4)."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Float64

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.rectangle import GraspRectangle
from preshape.grasps.space import GraspSpace

NAMES = ("u", "v", "angle", "opening")
UNITS = ("px", "px", "rad", "px")
JAW_PX = 25.0
"""Width of the jaws, which a planner does not choose: about the mean of the Cornell data."""
OPENING_PX = (8.0, 110.0)
"""The openings that occur in the Cornell data."""


def rectangle_space(
    name: str, width: int = WIDTH, height: int = HEIGHT, opening_px: Sequence[float] = OPENING_PX
) -> GraspSpace:
    """Grasp space of theta = (u, v, angle, opening), as in `GraspRectangle`, in the pixels of an image.

    The angle has no limits: theta and theta plus half a turn are the same grasp, and a planner may go round.

    Args:
        name: name of the space.
        width, height: of the image in pixels.
        opening_px: how far the jaws can be apart, from and to.
    """
    narrow, wide = opening_px
    lower = np.array([0.0, 0.0, -np.inf, narrow])
    upper = np.array([width - 1.0, height - 1.0, np.inf, wide])
    return GraspSpace(name, NAMES, UNITS, lower, upper, frame="image")


def theta_of(rectangle: GraspRectangle) -> Float64[np.ndarray, "4"]:
    """Theta of a rectangle; its angle is within [0, pi)."""
    return np.array([rectangle.u, rectangle.v, rectangle.angle_rad, rectangle.opening_px])


def rectangle_of(theta: Float[np.ndarray, "4"], jaw_px: float = JAW_PX) -> GraspRectangle:
    """The rectangle of theta, whose angle may be any, with jaws of a width that theta does not know."""
    u, v, angle, opening = theta.tolist()
    return GraspRectangle(u, v, angle, opening, jaw_px)
