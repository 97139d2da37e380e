"""The sampling baseline: the most promising of many random grasps."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import torch
from jaxtyping import Float64

from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, PlanStatus, rank_by


@dataclass(frozen=True)
class SamplingPlanner:
    """Draws grasps uniformly from the box of each start and keeps the best (paper, section 4.3: "sampling").

    The initial grasp competes too, so that the result is never worse than what was given.

    Args:
        samples_per_start: the paper draws 150 for its 3 initial grasps.
        seed: the same seed draws the same points in every box.
    """

    samples_per_start: int
    seed: int

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        begin = perf_counter()
        starts, dim = initial.shape
        start = bounds.project(initial)
        uniform = np.random.default_rng(self.seed).random((self.samples_per_start, starts, dim))
        drawn = bounds.project(bounds.lower + uniform * (bounds.upper - bounds.lower))
        candidates = np.concatenate((start[None], drawn))
        with torch.no_grad():
            evaluation = objective.evaluate(torch.from_numpy(candidates.reshape(-1, dim)))
        prob = evaluation.success_prob.numpy().reshape(-1, starts)
        value = evaluation.log_posterior.numpy().reshape(-1, starts)
        chosen = np.argmax(value, axis=0), np.arange(starts)
        return PlanResult(
            theta=candidates[chosen],
            success_prob=prob[chosen],
            log_posterior=value[chosen],
            initial_theta=start,
            initial_success_prob=prob[0],
            initial_log_posterior=value[0],
            ranking=rank_by(value[chosen]),
            status=(PlanStatus.NOT_OPTIMIZED,) * starts,
            iterations=np.zeros(starts, dtype=int),
            evaluations=value.size,
            runtime_s=perf_counter() - begin,
            climb=tuple(zip(prob[0].tolist(), prob[chosen].tolist(), strict=True)),
        )
