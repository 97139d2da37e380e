"""The sampling baseline: the most promising of many random grasps."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


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
        """See `Planner`."""
        best = BestSoFar(objective, initial, bounds)
        best.see(bounds.drawn(self.samples_per_start, self.seed))
        return best.result()
