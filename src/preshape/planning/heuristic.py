"""The heuristic baseline: initial grasps as they are."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import torch
from jaxtyping import Float64

from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, PlanStatus


@dataclass(frozen=True)
class HeuristicPlanner:
    """Returns the initial grasps in the order given (paper, section 4.3: "heuristic").

    Where there is a network, its probabilities are reported; they influence nothing.
    """

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        begin = perf_counter()
        theta = bounds.project(initial)
        with torch.no_grad():
            evaluation = objective.evaluate(torch.from_numpy(theta))
        starts = len(initial)
        prob, value = evaluation.success_prob.numpy(), evaluation.log_posterior.numpy()
        return PlanResult(
            theta=theta,
            success_prob=prob,
            log_posterior=value,
            initial_theta=theta,
            initial_success_prob=prob,
            initial_log_posterior=value,
            ranking=np.arange(starts),
            status=(PlanStatus.NOT_OPTIMIZED,) * starts,
            iterations=np.zeros(starts, dtype=int),
            evaluations=0,
            runtime_s=perf_counter() - begin,
            climb=tuple((p,) for p in prob.tolist()),
        )
