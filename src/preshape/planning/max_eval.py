"""The max-eval baseline: the most promising of the initial grasps."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from preshape.planning.bounds import Bounds
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, rank_by


@dataclass(frozen=True)
class MaxEvalPlanner:
    """Ranks the initial grasps by the objective and changes none (paper, section 4.3: "max-eval")."""

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        unranked = HeuristicPlanner().plan(objective, initial, bounds)
        return replace(unranked, ranking=rank_by(unranked.log_posterior), evaluations=len(initial))
