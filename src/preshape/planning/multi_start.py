"""Several starts for each initial grasp: the most promising of random ones are climbed from, too."""

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from jaxtyping import Float64, Int

from preshape.planning.best_so_far import BestSoFar
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.planner import Planner
from preshape.planning.result import PlanResult, merit, rank_by


@dataclass(frozen=True)
class MultiStart:
    """Plans from each initial grasp and from the best of random grasps in its box, and takes the best plan.

    A climb ends at the nearest summit, and the paper's initial grasps are few. To judge a random grasp costs
    a fraction of a climb.

    Args:
        method: plans from every start.
        samples: random grasps that are judged for each initial one, evenly distributed in its box.
        climbed: how many of them, the best ones, are planned from beside the initial grasp.
        seed: the same seed draws the same points in every box.
    """

    method: Planner
    samples: int
    climbed: int
    seed: int

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        begin = perf_counter()
        judged = BestSoFar(objective, initial, bounds)
        drawn = bounds.drawn(self.samples, self.seed)
        best = np.argsort(-judged.see(drawn), axis=0, kind="stable")[: self.climbed]
        starts = np.concatenate((initial[None], np.take_along_axis(drawn, best[:, :, None], axis=0)))
        count, owners, dim = starts.shape
        boxes = bounds[np.tile(np.arange(owners), count)]
        climbs = self.method.plan(objective, starts.reshape(-1, dim), boxes)
        merits = merit(climbs.log_posterior, climbs.violation_m).reshape(count, owners)
        chosen = merits.argmax(axis=0) * owners + np.arange(owners)
        return replace(
            _of_initial(climbs, chosen),
            evaluations=judged.result().evaluations + climbs.evaluations,
            runtime_s=perf_counter() - begin,
        )


def _of_initial(climbs: PlanResult, chosen: Int[np.ndarray, "s"]) -> PlanResult:
    """The chosen plans as those of the initial grasps, from which the first of all climbs began.

    A path goes from the initial grasp straight to the start of the climb that led to the plan.
    """
    rows = chosen.tolist()
    climb, path = climbs.climb, climbs.path
    away = [start != row for start, row in enumerate(rows)]
    values = {name: getattr(climbs, name)[chosen] for name in ("theta", "success_prob", "log_posterior")}
    first = ("initial_theta", "initial_success_prob", "initial_log_posterior")
    violation = climbs.violation_m[chosen]
    return PlanResult(
        **values,
        **{name: getattr(climbs, name)[: len(rows)] for name in first},
        ranking=rank_by(merit(values["log_posterior"], violation)),
        status=tuple(climbs.status[row] for row in rows),
        iterations=climbs.iterations[chosen] + away,
        evaluations=climbs.evaluations,
        runtime_s=climbs.runtime_s,
        climb=tuple(climb[s][: away[s]] + climb[row] for s, row in enumerate(rows)),
        violation_m=violation,
        path=tuple(np.concatenate((path[s][: away[s]], path[row])) for s, row in enumerate(rows)),
    )
