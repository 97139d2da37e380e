"""What every planner returns."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float64, Int


class PlanStatus(StrEnum):
    """Why a planner stopped at one start."""

    CONVERGED = "converged"
    """Nothing more to gain: the gradient, or the gain of the last steps, is within the tolerance."""
    AT_BOUNDS = "at_bounds"
    """As converged, with the gradient still pushing against at least one bound."""
    ITERATION_LIMIT = "iteration_limit"
    """Was still climbing when its iterations were used up."""
    NO_ASCENT = "no_ascent"
    """The line search found no higher point although the gradient is not zero."""
    NOT_OPTIMIZED = "not_optimized"
    """The planner does not climb: the grasp was given or picked, not improved."""
    INFEASIBLE = "infeasible"
    """No allowed grasp was found in the box; this one breaks the constraint the least."""


FORBIDDEN = 1e12
"""Far below any log posterior, with digits left for violations."""


@dataclass(frozen=True, eq=False)
class PlanResult:
    """The outcome of planning from s starts.

    Args:
        theta: planned grasps, within their bounds to the last bit.
        success_prob, log_posterior: what the objective says of them; NaN where no network was given.
        initial_theta, initial_success_prob, initial_log_posterior: the same before planning.
        ranking: the starts in the order in which their grasps should be tried.
        status: why the planner stopped, for each start.
        iterations: accepted steps of each start.
        evaluations: grasps shown to the network to find the plan (a gradient comes with its evaluation).
        runtime_s: wall-clock seconds of planning, image features not included.
        climb: for each start the success probability of its best grasp, before planning and after every
            iteration.
        violation_m: how far the planned grasps are from what is allowed; 0 where they are allowed, or where
            there is no constraint.
        path: for each start the grasps whose probabilities are in `climb`, from the initial to the planned
            one; empty for a plan that was read from a file, which does not keep them.
    """

    theta: Float64[np.ndarray, "s d"]
    success_prob: Float64[np.ndarray, "s"]
    log_posterior: Float64[np.ndarray, "s"]
    initial_theta: Float64[np.ndarray, "s d"]
    initial_success_prob: Float64[np.ndarray, "s"]
    initial_log_posterior: Float64[np.ndarray, "s"]
    ranking: Int[np.ndarray, "s"]
    status: tuple[PlanStatus, ...]
    iterations: Int[np.ndarray, "s"]
    evaluations: int
    runtime_s: float
    climb: tuple[tuple[float, ...], ...]
    violation_m: Float64[np.ndarray, "s"]
    path: tuple[Float64[np.ndarray, "_ d"], ...] = ()

    @property
    def best(self) -> int:
        """The start whose grasp should be tried first."""
        return int(self.ranking[0])


def merit(
    log_posterior: Float64[np.ndarray, "*s"], violation_m: Float64[np.ndarray, "*s"]
) -> Float64[np.ndarray, "*s"]:
    """What decides between two grasps: the log posterior of an allowed one.

    A grasp that is not allowed is worse than any that is, and the worse the farther it is from it.
    """
    chosen: Float64[np.ndarray, "*s"] = np.where(
        violation_m > 0, -FORBIDDEN * (1 + violation_m), log_posterior
    )
    return chosen


def rank_by(merits: Float64[np.ndarray, "s"]) -> Int[np.ndarray, "s"]:
    """Starts from the highest merit to the lowest; NaN last, equal ones in the given order."""
    return np.argsort(-np.nan_to_num(merits, nan=-np.inf), kind="stable")
