"""Projected gradient ascent inside the network: the paper's planner."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float64, Int64

from preshape.planning.bounds import Bounds
from preshape.planning.climb import Climb
from preshape.planning.landscape import Climbed, Landscape, Point
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, PlanStatus
from preshape.planning.threads import one_thread

StepUnit = Literal["raw", "half_width"]
"""What a step of 1 means. `raw`: theta moves by its gradient, metres and radians alike, as in the paper;
`half_width`: the box is scaled to a cube and the steepest parameter moves by half of its edge."""


@dataclass(frozen=True)
class GradientAscent:
    """Climbs from all starts at once (paper, section 2); each start goes its own way and stops by itself.

    Args:
        line_search: finds the step of each iteration.
        climbed: what is climbed, see `Climbed`.
        step_unit: what a step of 1 means, see `StepUnit`; `half_width` needs finite bounds.
        max_iterations: accepted steps that a start may take.
        tolerance: a start has converged once `patience` steps in a row, or to first order a move of one step
            unit, would gain no more than this, see `_worth`.
        patience: see `tolerance`.
    """

    line_search: LineSearch
    climbed: Climbed = "log_posterior"
    step_unit: StepUnit = "half_width"
    max_iterations: int = 100
    tolerance: float = 0.0
    patience: int = 1

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """See `Planner`."""
        landscape = Landscape(objective, self.climbed)
        with one_thread():
            climb = Climb(landscape.at(bounds.project(initial)), self.line_search.first_step)
            self._stop_where_flat(climb, climb.climbing, bounds)
            for _ in range(self.max_iterations):
                if len(climb.climbing) == 0:
                    break
                self._iterate(climb, landscape, bounds)
        return climb.result(landscape)

    def _iterate(self, climb: Climb, landscape: Landscape, bounds: Bounds) -> None:
        """One step of every start that still climbs."""
        rows = climb.climbing
        here, box = climb.here[rows], bounds[rows]
        found, accepted, step = self.line_search.search(
            landscape, here, self._direction(here, box), climb.step[rows], box
        )
        climb.stop(rows[~accepted], PlanStatus.NO_ASCENT)
        moved, found = rows[accepted], found[accepted.nonzero()[0]]
        gain = _worth(found.height - climb.here.height[moved], found)
        climb.idle[moved] = np.where(gain <= self.tolerance, climb.idle[moved] + 1, 0)
        climb.move(moved, found, step[accepted])
        self._stop_where_flat(climb, moved, bounds)

    def _stop_where_flat(self, climb: Climb, rows: Int64[np.ndarray, "m"], bounds: Bounds) -> None:
        """Stop the starts that have nothing more to gain."""
        here, box = climb.here[rows], bounds[rows]
        pushed = box.blocks(here.theta, here.gradient)
        slope = np.abs(np.where(pushed, 0.0, here.gradient) * self._scale(box)).max(axis=1)
        flat = (_worth(slope, here) <= self.tolerance) | (climb.idle[rows] >= self.patience)
        at_bounds = (pushed & ~box.fixed).any(axis=1)
        climb.stop(rows[flat & ~at_bounds], PlanStatus.CONVERGED)
        climb.stop(rows[flat & at_bounds], PlanStatus.AT_BOUNDS)

    def _direction(self, here: Point, box: Bounds) -> Float64[np.ndarray, "s d"]:
        """The gradient, without the parameters that would leave their bounds, in the unit of a step."""
        gradient = np.where(box.blocks(here.theta, here.gradient), 0.0, here.gradient)
        if self.step_unit == "raw":
            return gradient
        scaled = gradient * box.half_width
        direction: Float64[np.ndarray, "s d"] = (
            scaled * box.half_width / np.abs(scaled).max(axis=1, keepdims=True)
        )
        return direction

    def _scale(self, box: Bounds) -> Float64[np.ndarray, "s d"]:
        return np.ones_like(box.lower) if self.step_unit == "raw" else box.half_width


def _worth(gain: Float64[np.ndarray, "s"], at: Point) -> Float64[np.ndarray, "s"]:
    """What gains of log posterior are worth: without a prior, about the probability that is gained.

    Below a tenth they count as at a tenth. A climb from 10^-6 to 10^-5 leads nowhere, unless it goes on.
    """
    worth: Float64[np.ndarray, "s"] = gain * at.success_prob.clip(min=0.1)
    return worth
