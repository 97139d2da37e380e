"""What the networks of image patches need to know of a hand."""

from typing import Protocol, runtime_checkable

from jaxtyping import Float
from torch import Tensor


@runtime_checkable
class ProjectableHand(Protocol):
    """Where palm and fingertips of a grasp are, as differentiable functions of theta.

    Points are in the camera frame (m), or, for a grasp in the image, (u, v, 1) in pixels.

    Attributes:
        fingers: number f of its fingers.
    """

    @property
    def fingers(self) -> int: ...

    def palm(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 3"]:
        """Positions of the palm."""

    def fingertips(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b f 3"]:
        """Positions of the fingertips."""

    def direction(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 3"]:
        """Unit vectors that point upwards in the patches."""
