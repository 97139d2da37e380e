"""The max-eval baseline: the most promising of the initial grasps."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


@dataclass(frozen=True)
class MaxEvalPlanner:
    """Ranks the initial grasps by the objective and changes none (paper, section 4.3: "max-eval")."""

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        return BestSoFar(objective, initial, bounds).result()
