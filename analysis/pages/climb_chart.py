"""The climb of the success probability as lines of a chart."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from preshape.planning.grasp_plan import GraspPlan

WIDTH, HEIGHT = 580, 280
LEFT, RIGHT, TOP, BOTTOM = 48, 152, 14, 40
LABEL_SPACING = 16
"""Least distance between two labels, in the chart's units."""
MAX_TICKS = 8


@dataclass(frozen=True)
class Line:
    """One start.

    Args:
        name: face of its initial grasp.
        points: `x,y x,y ...` as SVG wants them.
        start, end: the first and the last point.
        label_y: height of its label, moved where labels would overlap.
        value: success probability at the end.
    """

    name: str
    points: str
    start: tuple[float, float]
    end: tuple[float, float]
    label_y: float
    value: float


@dataclass(frozen=True)
class ClimbChart:
    """Everything that the template draws.

    Args:
        lines: one for each start.
        x_ticks, y_ticks: (position, text) along the axes.
    """

    lines: tuple[Line, ...]
    x_ticks: tuple[tuple[float, str], ...]
    y_ticks: tuple[tuple[float, str], ...]
    width: int = WIDTH
    height: int = HEIGHT
    left: int = LEFT
    right: int = WIDTH - RIGHT
    top: int = TOP
    bottom: int = HEIGHT - BOTTOM


def climb_chart(plan: GraspPlan) -> ClimbChart:
    """Chart of a plan: iterations to the right, success probability from 0 to 1 upwards."""
    iterations = max(1, *(len(climb) - 1 for climb in plan.result.climb))

    def place(iteration: int, prob: float) -> tuple[float, float]:
        x = LEFT + iteration / iterations * (WIDTH - LEFT - RIGHT)
        return round(x, 1), round(HEIGHT - BOTTOM - prob * (HEIGHT - TOP - BOTTOM), 1)

    paths = [[place(i, prob) for i, prob in enumerate(climb)] for climb in plan.result.climb]
    label_ys = _spread([path[-1][1] for path in paths])
    lines = tuple(
        Line(
            face.value.replace("_", " "),
            " ".join(f"{x},{y}" for x, y in path),
            path[0],
            path[-1],
            label_y,
            climb[-1],
        )
        for face, path, label_y, climb in zip(plan.faces, paths, label_ys, plan.result.climb, strict=True)
    )
    x_ticks = tuple((place(i, 0)[0], str(i)) for i in range(0, iterations + 1, _tick_distance(iterations)))
    y_ticks = tuple((place(0, prob)[1], f"{prob:g}") for prob in (0, 0.25, 0.5, 0.75, 1))
    return ClimbChart(lines, x_ticks, y_ticks)


def _tick_distance(iterations: int) -> int:
    return next(step for step in (1, 2, 5, 10, 20, 50, 100, 10**9) if iterations / step <= MAX_TICKS)


def _spread(heights: Sequence[float]) -> list[float]:
    """Heights moved apart, in the same order, so that no two labels overlap."""
    order = sorted(range(len(heights)), key=lambda i: heights[i])
    spread = list(heights)
    for above, below in pairwise(order):
        spread[below] = max(spread[below], spread[above] + LABEL_SPACING)
    overflow = max(0.0, max(spread) - (HEIGHT - BOTTOM)) if spread else 0.0
    for i in reversed(order):
        spread[i] -= overflow
    return spread
