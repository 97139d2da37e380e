"""Arm configurations at a grasp pose from which the straight lines to it and up again can be followed."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from preshape.data.trial import TrialOutcome
from sim.arm.collision import CollisionChecker
from sim.arm.inverse_kinematics import InverseKinematics

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class LineSettings:
    """The straight lines of a grasp.

    Args:
        approach_m: length of the approach along the palm's normal.
        lift_m: length of the lift.
        step_m: distance between two configurations on a line.
        wanted: configurations with free lines that are collected before one is chosen.
    """

    approach_m: float = 0.1
    lift_m: float = 0.15
    step_m: float = 0.005
    wanted: int = 3


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way for the arm to hold the palm at the grasp pose.

    Args:
        approach: joint angles (rad) from the pre-grasp pose to the grasp pose.
        lift: joint angles (rad) from the grasp pose upwards.
    """

    approach: Float[np.ndarray, "n a"]
    lift: Float[np.ndarray, "m a"]


class NoMotionError(Exception):
    """There is no motion to a grasp.

    Args:
        outcome: UNREACHABLE or BLOCKED.
        reason: one sentence.
    """

    def __init__(self, outcome: TrialOutcome, reason: str) -> None:
        super().__init__(reason)
        self.outcome, self.reason = outcome, reason


class CandidateSearch:
    """Finds ways for the arm to hold the palm at a grasp pose.

    Args:
        inverse: gives arm configurations.
        checker: tells which are free.
        settings: the lines.
    """

    def __init__(self, inverse: InverseKinematics, checker: CollisionChecker, settings: LineSettings) -> None:
        self._inverse, self._checker, self._settings = inverse, checker, settings

    def candidates(self, T_world_palm: Float[np.ndarray, "4 4"], rng: np.random.Generator) -> list[Candidate]:
        """As many candidates as wanted, or fewer if the restarts run out; at least one.

        Raises:
            NoMotionError: if there is none.
        """
        found: list[Candidate] = []
        problems: list[str] = []
        for solution in self._inverse.solutions(T_world_palm, rng):
            if not (found or problems):
                self._check_hand(solution)
            tried = self._lines(solution, backwards=-T_world_palm[:3, 0])
            if isinstance(tried, str):
                problems.append(tried)
            else:
                found.append(tried)
            if len(found) == self._settings.wanted:
                break
        if found:
            return found
        if problems:
            (problem, count), *_ = Counter(problems).most_common(1)
            raise NoMotionError(
                TrialOutcome.BLOCKED, f"{problem} ({count} of {len(problems)} arm configurations)"
            )
        raise NoMotionError(
            TrialOutcome.UNREACHABLE, "no arm configuration within the limits reaches the pose"
        )

    def _check_hand(self, solution: Float[np.ndarray, "a"]) -> None:
        obstruction = self._checker.hand_obstruction(solution)
        if obstruction is not None:
            raise NoMotionError(TrialOutcome.BLOCKED, f"at the grasp pose the hand collides: {obstruction}")

    def _lines(self, grasp: Float[np.ndarray, "a"], backwards: Float[np.ndarray, "3"]) -> Candidate | str:
        """The candidate that a configuration at the grasp pose makes, or what is wrong with it."""
        checker, settings = self._checker, self._settings
        if not checker.is_free_but_for_hand_on_object(grasp):
            return "the arm collides at the grasp pose"
        retreat = self._inverse.line(grasp, backwards, settings.approach_m, settings.step_m)
        if retreat is None:
            return "the arm cannot follow the straight approach"
        if not all(checker.is_free_but_for_hand_on_object(positions) for positions in retreat):
            return "the arm or the hand collides on the straight approach"
        if not checker.is_clear(retreat[-1]):
            return "the pre-grasp pose is too close to the object"
        lift = self._inverse.line(grasp, UP, settings.lift_m, settings.step_m)
        if lift is None:
            return "the arm cannot follow the straight lift"
        if not all(checker.is_free(positions) for positions in lift):
            return "the arm or the hand collides on the straight lift"
        return Candidate(approach=retreat[::-1], lift=lift)
