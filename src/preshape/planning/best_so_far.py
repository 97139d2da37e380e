"""The best grasp that a planner without gradients has seen at each start."""

from time import perf_counter

import numpy as np
import torch
from jaxtyping import Float64, Int

from preshape.planning.bounds import Bounds
from preshape.planning.objective import Evaluation, Objective
from preshape.planning.result import PlanResult, PlanStatus, merit, rank_by
from preshape.planning.threads import one_thread


class BestSoFar:
    """Shows grasps to an objective and keeps the best of each start; the initial ones are the first.

    Args:
        objective: the objective.
        initial: initial grasps, projected onto their bounds first.
        bounds: the box of each start.

    Attributes:
        theta: the best grasps.
        merit: what they are worth, see `result.merit`.
    """

    def __init__(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> None:
        self._begin = perf_counter()
        self._objective, self._bounds = objective, bounds
        self._initial = bounds.project(initial)
        self._first = self._evaluate(self._initial)
        self.theta = self._initial.copy()
        self._values = {name: value.copy() for name, value in self._first.items()}
        self.merit = merit(self._values["log_posterior"], self._values["violation"])
        self._evaluations = 0
        self._history = [self._values["success_prob"].copy()]
        self._path = [self.theta.copy()]

    def see(self, drawn: Float64[np.ndarray, "n s d"]) -> Float64[np.ndarray, "n s"]:
        """The merits of n more grasps for each start, which lie within the bounds."""
        count, starts, dim = drawn.shape
        values = self._evaluate(drawn.reshape(-1, dim))
        merits = merit(values["log_posterior"], values["violation"]).reshape(count, starts)
        self._evaluations += merits.size
        rows = np.arange(starts)
        best = np.argmax(merits, axis=0)
        better = merits[best, rows] > self.merit
        taken, rows = best[better], rows[better]
        self.theta[rows] = drawn[taken, rows]
        self.merit[rows] = merits[taken, rows]
        for name, value in values.items():
            self._values[name][rows] = value.reshape(count, starts)[taken, rows]
        self._history.append(self._values["success_prob"].copy())
        self._path.append(self.theta.copy())
        return merits

    def result(self, ranking: Int[np.ndarray, "s"] | None = None, *, counted: bool = True) -> PlanResult:
        """The plan.

        Args:
            ranking: order in which the grasps should be tried; None for the order of their merits.
            counted: whether the initial grasps had to be evaluated to find it.
        """
        starts = len(self.theta)
        allowed = self._values["violation"] <= 0
        return PlanResult(
            theta=self.theta,
            success_prob=self._values["success_prob"],
            log_posterior=self._values["log_posterior"],
            initial_theta=self._initial,
            initial_success_prob=self._first["success_prob"],
            initial_log_posterior=self._first["log_posterior"],
            ranking=rank_by(self.merit) if ranking is None else ranking,
            status=tuple(PlanStatus.NOT_OPTIMIZED if ok else PlanStatus.INFEASIBLE for ok in allowed),
            iterations=np.full(starts, len(self._history) - 1),
            evaluations=self._evaluations + starts * counted,
            runtime_s=perf_counter() - self._begin,
            climb=tuple(zip(*(probs.tolist() for probs in self._history), strict=True)),
            violation_m=self._values["violation"],
            path=tuple(np.stack(self._path, axis=1)),
        )

    def _evaluate(self, theta: Float64[np.ndarray, "n d"]) -> dict[str, Float64[np.ndarray, "n"]]:
        with torch.no_grad(), one_thread():
            said: Evaluation = self._objective.evaluate(torch.from_numpy(theta))
        names = ("success_prob", "log_posterior", "violation")
        return {name: getattr(said, name).numpy() for name in names}
