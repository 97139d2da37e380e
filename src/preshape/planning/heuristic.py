"""The heuristic baseline: initial grasps as they are."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


@dataclass(frozen=True)
class HeuristicPlanner:
    """Returns the initial grasps in the order given (paper, section 4.3: "heuristic").

    Where there is a network, its probabilities are reported; they influence nothing.
    """

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        return BestSoFar(objective, initial, bounds).result(np.arange(len(initial)), counted=False)
