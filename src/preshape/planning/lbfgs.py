"""SciPy's L-BFGS-B, the usual choice for a smooth function in a box."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.optimize import minimize

from preshape.planning.bounds import Bounds
from preshape.planning.climb import Climb
from preshape.planning.landscape import Landscape
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, PlanStatus
from preshape.planning.threads import one_thread


@dataclass(frozen=True)
class LbfgsPlanner:
    """Climbs the log posterior from one start after the other; the best allowed grasp on its way is the plan.

    It follows no constraint but the box: a barrier turns it away from what is not allowed, and what it tries
    there is left out.

    Args:
        max_iterations: iterations per start.
        tolerance: ends a climb when the gradient in half widths of the box, or the relative gain of an
            iteration, is smaller.
    """

    max_iterations: int
    tolerance: float

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        landscape = Landscape(objective, "log_posterior")
        with one_thread():
            climb = Climb(landscape.at(bounds.project(initial)), 0.0)
            for start in range(len(initial)):
                self._climb(climb, start, landscape, bounds)
        return climb.result(landscape)

    def _climb(self, climb: Climb, start: int, landscape: Landscape, bounds: Bounds) -> None:
        rows = np.array([start])
        box = bounds[rows]
        unit = np.where(box.fixed, 1.0, box.half_width)

        def descent(scaled: Float64[np.ndarray, "d"]) -> tuple[float, Float64[np.ndarray, "d"]]:
            point = landscape.at(box.project(scaled * unit))
            climb.move(rows, point, np.zeros(1))
            return -float(point.height[0]), (-point.gradient * unit)[0]

        limits = list(zip((box.lower / unit)[0], (box.upper / unit)[0], strict=True))
        options = {"maxiter": self.max_iterations, "ftol": self.tolerance, "gtol": self.tolerance}
        begin = (climb.here.theta[rows] / unit)[0]
        done = minimize(descent, begin, jac=True, method="L-BFGS-B", bounds=limits, options=options)
        climb.stop(rows, PlanStatus.ITERATION_LIMIT if done.status == 1 else PlanStatus.CONVERGED)
