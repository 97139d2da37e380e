"""Timing of joint paths within the arm's limits, by TOPP-RA."""

import logging
from dataclasses import dataclass

import numpy as np
import toppra
from jaxtyping import Float
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint

from sim.arm.trajectory import JointTrajectory

logging.getLogger("toppra").setLevel(logging.ERROR)


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Largest speeds (rad/s) and accelerations (rad/s^2) of the arm's joints."""

    velocities: Float[np.ndarray, "a"]
    accelerations: Float[np.ndarray, "a"]


def fastest_trajectory(
    waypoints: Float[np.ndarray, "n a"], limits: JointLimits, period_s: float = 0.02
) -> JointTrajectory | None:
    """The fastest motion from rest to rest along a smooth curve through joint waypoints (rad).

    Args:
        waypoints: joint angles (rad), dense enough that the curve between them is harmless.
        limits: what the joints may do.
        period_s: time between two samples of the answer.

    Returns:
        The motion, or None if the limits allow none.
    """
    steps = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    return _parametrise(np.concatenate(([0.0], np.cumsum(steps))), waypoints, limits, period_s)


def line_trajectory(
    waypoints: Float[np.ndarray, "n a"],
    length_m: float,
    speed_m_s: float,
    acceleration_m_s2: float,
    limits: JointLimits,
    period_s: float = 0.02,
) -> JointTrajectory | None:
    """Motion from rest to rest along a line of the palm, at constant speed but for its ends.

    Args:
        waypoints: joint angles (rad) at equal distances along the line.
        length_m: length of the line.
        speed_m_s, acceleration_m_s2: of the palm along it.
        limits: what the joints may do.
        period_s: time between two samples of the answer.

    Returns:
        The motion, or None if the limits allow none.
    """
    # The distance travelled is one more joint, whose limits are the palm's speed and acceleration.
    travelled = np.linspace(0.0, length_m, len(waypoints))
    with_distance = JointLimits(
        np.append(limits.velocities, speed_m_s), np.append(limits.accelerations, acceleration_m_s2)
    )
    motion = _parametrise(travelled, np.column_stack((waypoints, travelled)), with_distance, period_s)
    if motion is None:
        return None
    return JointTrajectory(motion.times, motion.positions[:, :-1], motion.velocities[:, :-1])


def _parametrise(
    distances: Float[np.ndarray, "n"],
    waypoints: Float[np.ndarray, "n a"],
    limits: JointLimits,
    period_s: float,
) -> JointTrajectory | None:
    path = toppra.SplineInterpolator(distances, waypoints)
    constraints = [
        JointVelocityConstraint(np.stack((-limits.velocities, limits.velocities), axis=1)),
        JointAccelerationConstraint(np.stack((-limits.accelerations, limits.accelerations), axis=1)),
    ]
    grid = np.linspace(0.0, distances[-1], max(50, 2 * len(waypoints)))
    motion = TOPPRA(constraints, path, gridpoints=grid, solver_wrapper="seidel").compute_trajectory(0, 0)
    if motion is None:
        return None
    times = np.linspace(0.0, motion.duration, max(2, int(np.ceil(motion.duration / period_s)) + 1))
    return JointTrajectory(times, motion(times), motion(times, 1))
