"""Backtracking line search along the projected gradient, for many starts at once."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from preshape.planning.bounds import Bounds
from preshape.planning.landscape import Landscape, Point


@dataclass(frozen=True)
class LineSearch:
    """Tries a step, projects it onto the bounds, and shrinks the step until the point is higher.

    A point that is not allowed is not higher; from a start that is not allowed, no point that is less so.

    The paper gives "a maximum of 10 iterations" and a "control parameter of 0.5", which may be read as the
    factor that shrinks the step or as Armijo's fraction of the predicted increase. The released code halves
    the step and accepts any increase: `shrink` = 0.5 and `sufficient_increase` = 0 follow it, while
    `sufficient_increase` = 0.5 is the other reading.

    Args:
        first_step: first step of the first search.
        max_halvings: how often one search may shrink its step.
        shrink: factor by which a rejected step shrinks, between 0 and 1.
        sufficient_increase: fraction c, 0 <= c < 1, of the increase predicted by the gradient that a step
            must reach, f(x') > f(x) + c g.(x' - x) (Armijo); 0 accepts any increase.
        growth: None begins every search with `first_step`; else a search begins with the step that the last
            one accepted, times this factor if that was its first try.
        max_step: no search begins with a longer step.
    """

    first_step: float
    max_halvings: int = 10
    shrink: float = 0.5
    sufficient_increase: float = 0.0
    growth: float | None = None
    max_step: float = float("inf")

    def search(
        self,
        landscape: Landscape,
        start: Point,
        direction: Float64[np.ndarray, "s d"],
        step: Float64[np.ndarray, "s"],
        bounds: Bounds,
    ) -> tuple[Point, Bool[np.ndarray, "s"], Float64[np.ndarray, "s"]]:
        """One search for each start.

        Args:
            landscape: evaluates points.
            start: where the searches begin.
            direction: of ascent; a step t tries the projection of theta + t direction.
            step: with which each search begins.
            bounds: the box of each start.

        Returns:
            the higher points (unchanged where none was found), which starts found one, and the step with
            which the next search of each start begins.
        """
        rows = np.arange(len(step))
        found, accepted, step = start[rows], np.full(len(step), False), step.copy()
        for trial in range(self.max_halvings + 1):
            origin = start[rows]
            theta = bounds[rows].project(origin.theta + step[rows, None] * direction[rows])
            predicted = (origin.gradient * (theta - origin.theta)).sum(axis=1)
            enough = origin.height + self.sufficient_increase * np.maximum(predicted, 0)
            higher, points = landscape.points_above(theta, replace(origin, height=enough))
            found[rows[higher]] = points
            accepted[rows[higher]] = True
            if trial == 0 and self.growth is not None:
                step[rows[higher]] *= self.growth
            rows = rows[~higher]
            if len(rows) == 0:
                break
            step[rows] *= self.shrink
        return found, accepted, self._next_step(step)

    def _next_step(self, step: Float64[np.ndarray, "s"]) -> Float64[np.ndarray, "s"]:
        return np.full_like(step, self.first_step) if self.growth is None else step.clip(max=self.max_step)
