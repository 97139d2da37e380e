"""Inverse kinematics by damped least squares with restarts, and lines followed by it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.linalg.lapack import dposv

from sim.arm.kinematics import ArmKinematics


@dataclass(frozen=True)
class InverseKinematicsSettings:
    """How arm configurations are searched for.

    Args:
        restarts: random starting points tried per pose.
        steps: iterations from each starting point.
        tolerance_m, tolerance_rad: how close a solution comes.
        limit_margin_rad: distance that solutions keep from the joint limits.
        distinct_rad: solutions count as different if some joint differs by this much.
    """

    restarts: int = 60
    steps: int = 20
    tolerance_m: float = 1e-5
    tolerance_rad: float = 1e-4
    limit_margin_rad: float = 0.01
    distinct_rad: float = 0.3


class InverseKinematics:
    """Arm configurations that put the palm at a pose.

    Levenberg-Marquardt with a damping that falls with the error (Sugihara 2011), which stays calm where the
    pose is out of reach.

    Args:
        kinematics: the arm.
        settings: how to search.
    """

    def __init__(self, kinematics: ArmKinematics, settings: InverseKinematicsSettings) -> None:
        self._kinematics, self._settings = kinematics, settings
        self._lower = kinematics.lower + settings.limit_margin_rad
        self._upper = kinematics.upper - settings.limit_margin_rad

    def solutions(
        self, T_world_palm: Float[np.ndarray, "4 4"], rng: np.random.Generator
    ) -> Iterator[Float[np.ndarray, "a"]]:
        """Distinct solutions within the joint limits, found one by one from random starts."""
        found: list[Float[np.ndarray, "a"]] = []
        for _ in range(self._settings.restarts):
            solution = self.refine(T_world_palm, rng.uniform(self._lower, self._upper))
            if solution is not None and self._is_new(solution, found):
                found.append(solution)
                yield solution

    def refine(
        self, T_world_palm: Float[np.ndarray, "4 4"], start: Float[np.ndarray, "a"]
    ) -> Float[np.ndarray, "a"] | None:
        """The solution that `start` leads to, or None."""
        settings = self._settings
        target, positions = self._kinematics.link_target(T_world_palm), start
        for _ in range(settings.steps):
            error, jacobian = self._kinematics.error_and_jacobian(target, positions)
            if _length(error[:3]) < settings.tolerance_m and _length(error[3:]) < settings.tolerance_rad:
                return positions
            normal = jacobian.T @ jacobian
            normal.flat[:: len(normal) + 1] += 0.5 * (error @ error) + 1e-6
            _, step, _ = dposv(normal, jacobian.T @ error)
            positions = np.minimum(np.maximum(positions + step, self._lower), self._upper)
        return None

    def line(
        self,
        start: Float[np.ndarray, "a"],
        direction: Float[np.ndarray, "3"],
        length_m: float,
        step_m: float,
        largest_joint_step_rad: float = 0.15,
    ) -> Float[np.ndarray, "n a"] | None:
        """Configurations that move the palm straight from where `start` has it, without turning it.

        Args:
            start: joint angles (rad).
            direction: unit vector in the world.
            length_m, step_m: length of the line, and of the steps on it at most.
            largest_joint_step_rad: a joint that moves further within one step has jumped.

        Returns:
            Joint angles (rad) at equal distances from start to end, or None if the arm cannot follow.
        """
        pose, positions = self._kinematics.palm_pose(start), [start]
        for travelled in np.linspace(0.0, length_m, int(np.ceil(length_m / step_m)) + 1)[1:]:
            target = pose.copy()
            target[:3, 3] += travelled * direction
            position = self.refine(target, positions[-1])
            if position is None or np.abs(position - positions[-1]).max() > largest_joint_step_rad:
                return None
            positions.append(position)
        return np.array(positions)

    def _is_new(self, solution: Float[np.ndarray, "a"], found: list[Float[np.ndarray, "a"]]) -> bool:
        return all(np.abs(solution - other).max() > self._settings.distinct_rad for other in found)


def _length(vector: Float[np.ndarray, "3"]) -> float:
    return float(vector @ vector) ** 0.5
