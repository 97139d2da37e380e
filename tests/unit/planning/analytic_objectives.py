"""Objectives whose optimum is known."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from preshape.planning.objective import Evaluation, Objective

Function = Callable[[Tensor], Tensor]


class AnalyticObjective(Objective):
    """An objective with a given logit and log prior."""

    def __init__(
        self, logit: Callable[[Tensor], Tensor], log_prior: Callable[[Tensor], Tensor] | None = None
    ):
        self._logit = logit
        self._log_prior = log_prior or (lambda theta: torch.zeros_like(theta[:, 0]))

    def evaluate(self, theta: Tensor) -> Evaluation:
        return Evaluation.of(self._logit(theta), self._log_prior(theta))


def quadratic(centre: np.ndarray, curvature: np.ndarray) -> AnalyticObjective:
    """Concave logit with its maximum 1 at `centre`."""
    target, weights = torch.from_numpy(centre), torch.from_numpy(curvature)
    return AnalyticObjective(lambda theta: 1 - (weights * (theta - target).square()).sum(dim=1))


def rosenbrock(steepness: float) -> AnalyticObjective:
    """A curved ridge in two dimensions with its maximum 0 at (1, 1)."""

    def logit(theta: Tensor) -> Tensor:
        x, y = theta.unbind(dim=1)
        return -(1 - x).square() - steepness * (y - x.square()).square()

    return AnalyticObjective(logit)


def linear(slope: np.ndarray) -> AnalyticObjective:
    """A logit that grows for ever along `slope`."""
    return AnalyticObjective(lambda theta: theta @ torch.from_numpy(slope))
