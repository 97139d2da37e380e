"""The objective as a climber sees it: heights and gradients of points, and how many were looked at."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from jaxtyping import Bool, Float64, Int

from preshape.planning.objective import Objective

Climbed = Literal["logit", "log_posterior"]
"""What is climbed. `logit`: as in the paper; its line search compares probabilities, which have the same
order, and its prior is uniform, so none enters. `log_posterior`: the objective itself."""


@dataclass(frozen=True, eq=False)
class Point:
    """Where s starts stand.

    Args:
        theta: grasps.
        height: value of what is climbed.
        gradient: of the height with respect to theta.
        success_prob, log_posterior: see `Evaluation`.
    """

    theta: Float64[np.ndarray, "s d"]
    height: Float64[np.ndarray, "s"]
    gradient: Float64[np.ndarray, "s d"]
    success_prob: Float64[np.ndarray, "s"]
    log_posterior: Float64[np.ndarray, "s"]

    def __getitem__(self, rows: Int[np.ndarray, "m"]) -> "Point":
        """Some of the starts."""
        return Point(
            self.theta[rows],
            self.height[rows],
            self.gradient[rows],
            self.success_prob[rows],
            self.log_posterior[rows],
        )

    def __setitem__(self, rows: Int[np.ndarray, "m"], other: "Point") -> None:
        """Move some of the starts to other points."""
        self.theta[rows] = other.theta
        self.height[rows] = other.height
        self.gradient[rows] = other.gradient
        self.success_prob[rows] = other.success_prob
        self.log_posterior[rows] = other.log_posterior


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
        self.evaluations = 0

    def at(self, theta: Float64[np.ndarray, "s d"]) -> Point:
        """The points theta."""
        return self._points(theta, None)[1]

    def points_above(
        self, theta: Float64[np.ndarray, "s d"], height: Float64[np.ndarray, "s"]
    ) -> tuple[Bool[np.ndarray, "s"], Point]:
        """Which of the points theta lie above the given heights, and those points.

        Only they get a gradient, from the evaluation that they have had already.
        """
        return self._points(theta, height)

    def _points(
        self, theta: Float64[np.ndarray, "s d"], height: Float64[np.ndarray, "s"] | None
    ) -> tuple[Bool[np.ndarray, "s"], Point]:
        leaf = torch.from_numpy(theta).requires_grad_()
        evaluation = self._objective.evaluate(leaf)
        self.evaluations += len(theta)
        climbed = evaluation.logit if self._climbed == "logit" else evaluation.log_posterior
        heights = climbed.detach().numpy()
        wanted = np.full(len(theta), True) if height is None else heights > height
        gradient = np.zeros_like(theta)
        if wanted.any():
            gradient = torch.autograd.grad(climbed, leaf, torch.from_numpy(wanted).to(climbed))[0].numpy()
        prob = evaluation.success_prob.detach().numpy()
        log_posterior = evaluation.log_posterior.detach().numpy()
        return wanted, Point(theta, heights, gradient, prob, log_posterior)[wanted.nonzero()[0]]
