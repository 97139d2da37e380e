"""The cross-entropy method: sampling that learns where good grasps are."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


@dataclass(frozen=True)
class CrossEntropyPlanner:
    """Draws from a normal distribution around each start and fits it to the best that it drew, in rounds.

    Numbers outside of the box are put onto its surface. Elites are taken by merit, so that grasps that are
    not allowed make way for those that are. The best grasp ever seen is the plan.

    Args:
        rounds: how often grasps are drawn.
        samples_per_round: grasps per round and start.
        elite_share: share of them that the next distribution is fitted to.
        smoothing: weight of the fit; the rest is the distribution that was.
        first_deviation: standard deviation of the first round, in half widths of the box.
        seed: the same seed draws the same numbers for every start.
    """

    rounds: int
    samples_per_round: int
    elite_share: float
    smoothing: float
    first_deviation: float
    seed: int

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        rng = np.random.default_rng(self.seed)
        best = BestSoFar(objective, initial, bounds)
        mean, deviation = best.theta.copy(), self.first_deviation * bounds.half_width
        elites = max(1, round(self.elite_share * self.samples_per_round))
        for _ in range(self.rounds):
            # The same numbers for every start, so that a batch gives what its starts give one by one.
            normal = rng.standard_normal((self.samples_per_round, 1, initial.shape[1]))
            drawn = bounds.project(mean + normal * deviation)
            order = np.argsort(-best.see(drawn), axis=0)[:elites]
            chosen = np.take_along_axis(drawn, order[..., None], axis=0)
            mean += self.smoothing * (chosen.mean(axis=0) - mean)
            deviation += self.smoothing * (chosen.std(axis=0) - deviation)
        return best.result()
