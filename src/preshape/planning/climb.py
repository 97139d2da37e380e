"""How far each start of a gradient ascent has come."""

import numpy as np
from jaxtyping import Float64, Int64

from preshape.planning.landscape import Landscape, Point
from preshape.planning.result import PlanResult, PlanStatus, rank_by


class Climb:
    """The state of s starts that climb side by side; `move` and `stop` change it.

    Args:
        first: where the starts begin.
        first_step: the step of their first line search.

    Attributes:
        here: where the starts stand.
        best: the best grasp of each start so far. Unless a barrier or a prior that is not climbed pushes it
            away, a start stands on it.
        step: with which the next line search of each start begins.
        idle: how many of its last steps in a row gained next to nothing.
        climbing: the starts that have not stopped.
        status: why the others have.
    """

    def __init__(self, first: Point, first_step: float) -> None:
        starts = len(first.theta)
        self._first = first
        self.climbing = np.arange(starts)
        self.here = first[self.climbing]
        self.best = first[self.climbing]
        self.step = np.full(starts, first_step)
        self.idle = np.zeros(starts, dtype=np.int64)
        self.status = [PlanStatus.ITERATION_LIMIT] * starts
        self._probs = [[prob] for prob in first.success_prob.tolist()]
        self._path = [[theta] for theta in first.theta]

    @property
    def iterations(self) -> Int64[np.ndarray, "s"]:
        """Accepted steps of each start."""
        return np.array([len(probs) - 1 for probs in self._probs])

    @property
    def history(self) -> tuple[tuple[float, ...], ...]:
        """Success probability of each start's best grasp before the climb and after each of its steps."""
        return tuple(tuple(probs) for probs in self._probs)

    def move(self, rows: Int64[np.ndarray, "m"], to: Point, step: Float64[np.ndarray, "m"]) -> None:
        """Take an accepted step with some of the starts.

        Args:
            rows: the starts.
            to: where they go.
            step: with which their next line search begins.
        """
        self.here[rows] = to
        self.step[rows] = step
        better = (to.merit >= self.best.merit[rows]).nonzero()[0]
        self.best[rows[better]] = to[better]
        best = self.best[rows]
        for row, prob, theta in zip(rows.tolist(), best.success_prob.tolist(), best.theta, strict=True):
            self._probs[row].append(prob)
            self._path[row].append(theta)

    def stop(self, rows: Int64[np.ndarray, "m"], status: PlanStatus) -> None:
        """Some of the starts climb no further."""
        if len(rows):
            self.climbing = np.setdiff1d(self.climbing, rows)
        for row in rows.tolist():
            self.status[row] = status

    def result(self, landscape: Landscape) -> PlanResult:
        """The plan, after a climb in this landscape."""
        first, best = self._first, self.best
        allowed = (best.violation <= 0).tolist()
        outcomes = zip(self.status, allowed, strict=True)
        return PlanResult(
            theta=best.theta,
            success_prob=best.success_prob,
            log_posterior=best.log_posterior,
            initial_theta=first.theta,
            initial_success_prob=first.success_prob,
            initial_log_posterior=first.log_posterior,
            ranking=rank_by(best.merit),
            status=tuple(status if ok else PlanStatus.INFEASIBLE for status, ok in outcomes),
            iterations=self.iterations,
            evaluations=landscape.evaluations,
            runtime_s=landscape.runtime_s,
            climb=self.history,
            violation_m=best.violation,
            path=tuple(np.array(thetas) for thetas in self._path),
        )
