"""How far each start of a gradient ascent has come."""

import numpy as np
from jaxtyping import Float64, Int64

from preshape.planning.landscape import Point
from preshape.planning.result import PlanStatus


class Climb:
    """The state of s starts that climb side by side; `move` and `stop` change it.

    Args:
        first: where the starts begin.
        first_step: the step of their first line search.

    Attributes:
        here: where the starts stand.
        step: with which the next line search of each start begins.
        idle: how many of its last steps in a row gained no more than the tolerance.
        climbing: the starts that have not stopped.
        status: why the others have.
    """

    def __init__(self, first: Point, first_step: float) -> None:
        starts = len(first.theta)
        self.climbing = np.arange(starts)
        self.here = first[self.climbing]
        self.step = np.full(starts, first_step)
        self.idle = np.zeros(starts, dtype=np.int64)
        self.status = [PlanStatus.ITERATION_LIMIT] * starts
        self._probs = [[prob] for prob in first.success_prob.tolist()]

    @property
    def iterations(self) -> Int64[np.ndarray, "s"]:
        """Accepted steps of each start."""
        return np.array([len(probs) - 1 for probs in self._probs])

    @property
    def history(self) -> tuple[tuple[float, ...], ...]:
        """Success probability of each start before the climb and after each of its steps."""
        return tuple(tuple(probs) for probs in self._probs)

    def move(
        self, rows: Int64[np.ndarray, "m"], to: Point, step: Float64[np.ndarray, "m"], tolerance: float
    ) -> None:
        """Take an accepted step with some of the starts.

        Args:
            rows: the starts.
            to: where they go.
            step: with which their next line search begins.
            tolerance: a step that gains no more than this counts as idle.
        """
        gain = to.height - self.here.height[rows]
        self.idle[rows] = np.where(gain > tolerance, 0, self.idle[rows] + 1)
        self.here[rows] = to
        self.step[rows] = step
        for row, prob in zip(rows.tolist(), to.success_prob.tolist(), strict=True):
            self._probs[row].append(prob)

    def stop(self, rows: Int64[np.ndarray, "m"], status: PlanStatus) -> None:
        """Some of the starts climb no further."""
        if len(rows):
            self.climbing = np.setdiff1d(self.climbing, rows)
        for row in rows.tolist():
            self.status[row] = status
