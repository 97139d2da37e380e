"""What the arm's planner answers: a motion in three parts, or why there is none."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicHermiteSpline

from preshape.data.trial import TrialOutcome


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """A smooth motion of the arm's joints, from rest to rest.

    Between its samples it is the cubic that fits their positions and velocities.

    Args:
        times: seconds from the start, increasing from 0.
        positions: joint angles (rad).
        velocities: joint velocities (rad/s).
    """

    times: Float[np.ndarray, "n"]
    positions: Float[np.ndarray, "n a"]
    velocities: Float[np.ndarray, "n a"]

    @property
    def duration_s(self) -> float:
        """Seconds from the first sample to the last."""
        return float(self.times[-1])

    def sample(
        self, times_s: Float[np.ndarray, "t"]
    ) -> tuple[Float[np.ndarray, "t a"], Float[np.ndarray, "t a"]]:
        """Joint angles (rad) and velocities (rad/s) at some times; outside of the motion, the arm rests."""
        position, velocity = self._splines
        clipped = np.clip(times_s, 0.0, self.duration_s)
        moves = (times_s >= 0) & (times_s < self.duration_s)
        return position(clipped), np.where(moves[:, None], velocity(clipped), 0.0)

    def spaced_positions(self, spacing_rad: float) -> Float[np.ndarray, "m a"]:
        """Joint angles (rad) along the motion, including both ends, about `spacing_rad` from each other."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=1)
        travelled = np.concatenate(([0.0], np.cumsum(steps)))
        count = int(np.ceil(travelled[-1] / spacing_rad)) + 1
        times = np.interp(np.linspace(0.0, travelled[-1], count), travelled, self.times)
        return self._splines[0](times)

    @cached_property
    def _splines(self) -> tuple[CubicHermiteSpline, CubicHermiteSpline]:
        position = CubicHermiteSpline(self.times, self.positions, self.velocities)
        return position, position.derivative()


@dataclass(frozen=True)
class PlanningTimes:
    """Wall-clock seconds of the parts of a query.

    Args:
        inverse_kinematics_s: solutions, straight lines and their collision checks.
        path_s: the search for free paths.
        timing_s: fitting velocities to paths.
    """

    inverse_kinematics_s: float = 0.0
    path_s: float = 0.0
    timing_s: float = 0.0


@dataclass(frozen=True, eq=False)
class GraspMotion:
    """The arm's whole motion to a grasp and up again.

    Args:
        transit: free motion from rest to the pre-grasp pose.
        approach: straight line along the palm's normal to the grasp pose.
        lift: straight line upwards.
        times: how long planning took.
    """

    transit: JointTrajectory
    approach: JointTrajectory
    lift: JointTrajectory
    times: PlanningTimes


@dataclass(frozen=True)
class MotionFailure:
    """Why there is no motion to a grasp.

    Args:
        outcome: UNREACHABLE (no arm configuration has the palm there) or BLOCKED (some do, but they collide,
            or no free path or straight line leads there and up again).
        reason: one sentence.
        times: how long planning took.
    """

    outcome: TrialOutcome
    reason: str
    times: PlanningTimes
