"""How far predicted grasps are from grasps that lifted (paper, section 4.2, the regression network)."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class ErrorSummary:
    """Mean, median and smallest of some errors; NaN if there are none."""

    mean: float
    median: float
    smallest: float


@dataclass(frozen=True)
class GraspErrors:
    """Errors of predicted grasps against successful ones of the same views.

    Args:
        n: number of grasps.
        palm_m: distance of the palms (m).
        orientation_rad: angle of the rotation between the palms (rad).
        joints_rad: mean absolute error of the preshape joints (rad).
    """

    n: int
    palm_m: ErrorSummary
    orientation_rad: ErrorSummary
    joints_rad: ErrorSummary

    def summary(self) -> str:
        """The mean errors in words."""
        return (
            f"palm {self.palm_m.mean:.3f} m, orientation {self.orientation_rad.mean:.2f} rad, joints "
            f"{self.joints_rad.mean:.2f} rad off on {self.n} held-out trials, all of them lifted"
        )

    def scalars(self) -> dict[str, float]:
        """The number of grasps, mean errors and the smallest of the palm by their names, each a number."""
        means = {name: getattr(self, name).mean for name in ("palm_m", "orientation_rad", "joints_rad")}
        return {"n": float(self.n), **means, "palm_smallest_m": self.palm_m.smallest}

    def to_dict(self) -> dict[str, Any]:
        """The errors as they stand in result files."""
        return asdict(self)


def grasp_errors(predicted: Float[np.ndarray, "n d"], lifted: Float[np.ndarray, "n d"]) -> GraspErrors:
    """Errors of grasps theta = (palm position, Euler angles, joints) in the camera frame.

    Orientations are compared as rotations, so that angles which wrap or pitches at their singularity do not
    count as errors.

    Args:
        predicted: what a network predicted for a view.
        lifted: a grasp that lifted in that view.
    """
    turn = _rotations(predicted).inv() * _rotations(lifted)
    return GraspErrors(
        n=len(lifted),
        palm_m=_summary(np.linalg.norm(predicted[:, :3] - lifted[:, :3], axis=1)),
        orientation_rad=_summary(turn.magnitude()),
        joints_rad=_summary(np.abs(predicted[:, 6:] - lifted[:, 6:]).mean(axis=1)),
    )


def _rotations(theta: Float[np.ndarray, "n d"]) -> Rotation:
    return Rotation.from_euler("xyz", theta[:, 3:6])


def _summary(errors: Float[np.ndarray, "n"]) -> ErrorSummary:
    if not len(errors):
        return ErrorSummary(float("nan"), float("nan"), float("nan"))
    return ErrorSummary(float(errors.mean()), float(np.median(errors)), float(errors.min()))
