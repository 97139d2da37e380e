"""The objective as a climber sees it: heights and gradients of points, and how many were looked at."""

from dataclasses import dataclass, fields
from time import perf_counter
from typing import Literal

import numpy as np
import torch
from jaxtyping import Bool, Float64, Int

from preshape.planning.objective import Objective
from preshape.planning.result import merit

Climbed = Literal["logit", "log_posterior"]
"""What is climbed. `logit`: as in the paper; its line search compares probabilities, which have the same
order, and its prior is uniform, so none enters. `log_posterior`: the objective itself. The barrier before
what is not allowed is added to either."""


@dataclass(frozen=True, eq=False)
class Point:
    """Where s starts stand.

    Args:
        theta: grasps.
        height: value of what is climbed.
        gradient: of the height with respect to theta.
        success_prob, log_posterior, violation: see `Evaluation`.
    """

    theta: Float64[np.ndarray, "s d"]
    height: Float64[np.ndarray, "s"]
    gradient: Float64[np.ndarray, "s d"]
    success_prob: Float64[np.ndarray, "s"]
    log_posterior: Float64[np.ndarray, "s"]
    violation: Float64[np.ndarray, "s"]

    @property
    def merit(self) -> Float64[np.ndarray, "s"]:
        """What the points are worth as grasps."""
        return merit(self.log_posterior, self.violation)

    def __getitem__(self, rows: Int[np.ndarray, "m"]) -> "Point":
        """Some of the starts."""
        return Point(*(getattr(self, name)[rows] for name in FIELDS))

    def __setitem__(self, rows: Int[np.ndarray, "m"], other: "Point") -> None:
        """Move some of the starts to other points."""
        for name in FIELDS:
            getattr(self, name)[rows] = getattr(other, name)


FIELDS = tuple(field.name for field in fields(Point))


class Landscape:
    """An objective whose evaluations are counted.

    Args:
        objective: the objective.
        climbed: which of its values is the height.

    Attributes:
        evaluations: grasps evaluated so far.
    """

    def __init__(self, objective: Objective, climbed: Climbed) -> None:
        self._objective = objective
        self._climbed = climbed
        self._begin = perf_counter()
        self.evaluations = 0

    @property
    def runtime_s(self) -> float:
        """Seconds since the landscape was made."""
        return perf_counter() - self._begin

    def at(self, theta: Float64[np.ndarray, "s d"]) -> Point:
        """The points theta."""
        return self._points(theta, None)[1]

    def points_above(
        self, theta: Float64[np.ndarray, "s d"], floor: Point
    ) -> tuple[Bool[np.ndarray, "s"], Point]:
        """Which of the points theta lie above the heights of a floor, and those points.

        A point that violates the constraint more than its floor does not count, whatever its height. Only
        those that count get a gradient, from the evaluation that they have had already.
        """
        return self._points(theta, floor)

    def _points(
        self, theta: Float64[np.ndarray, "s d"], floor: Point | None
    ) -> tuple[Bool[np.ndarray, "s"], Point]:
        leaf = torch.from_numpy(theta).requires_grad_()
        evaluation = self._objective.evaluate(leaf)
        self.evaluations += len(theta)
        climbed = evaluation.logit if self._climbed == "logit" else evaluation.log_posterior
        climbed = climbed + evaluation.log_barrier
        heights, violation = climbed.detach().numpy(), evaluation.violation.numpy()
        wanted = np.full(len(theta), True)
        if floor is not None:
            wanted = (heights > floor.height) & (violation <= floor.violation)
        gradient = np.zeros_like(theta)
        if wanted.any():
            gradient = torch.autograd.grad(climbed, leaf, torch.from_numpy(wanted).to(climbed))[0].numpy()
        prob = evaluation.success_prob.detach().numpy()
        log_posterior = evaluation.log_posterior.detach().numpy()
        point = Point(theta, heights, gradient, prob, log_posterior, violation)
        return wanted, point[wanted.nonzero()[0]]
