"""Random search: a climber without gradients."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


@dataclass(frozen=True)
class RandomSearchPlanner:
    """Tries random moves from the best grasp of each start so far; their length shrinks in equal ratios.

    Args:
        rounds: moves of each start, one evaluation each.
        first_deviation, last_deviation: standard deviation of the moves, in half widths of the box.
        seed: the same seed draws the same numbers for every start.
    """

    rounds: int
    first_deviation: float
    last_deviation: float
    seed: int

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        rng = np.random.default_rng(self.seed)
        best = BestSoFar(objective, initial, bounds)
        for deviation in np.geomspace(self.first_deviation, self.last_deviation, self.rounds):
            move = deviation * rng.standard_normal(initial.shape[1]) * bounds.half_width
            best.see(bounds.project(best.theta + move)[None])
        return best.result()
