"""What is demanded of a grasp beside its success, and how climbers keep to it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float64
from torch import Tensor

from preshape.planning.objective import Evaluation, Objective


@dataclass(frozen=True, eq=False)
class Slack:
    """How s grasps meet k demands.

    Args:
        values: by how much (m) each demand is met; negative where it is not.
        pull_back: gradient by theta of the sum of the values of each grasp, weighted by what it is given.
    """

    values: Float64[np.ndarray, "s k"]
    pull_back: Callable[[Float64[np.ndarray, "s k"]], Float64[np.ndarray, "s d"]]


@runtime_checkable
class Constraint(Protocol):
    """What is demanded of a grasp."""

    def slack(self, theta: Float64[np.ndarray, "s d"]) -> Slack:
        """How s grasps meet the demands, each by itself."""
        ...


@dataclass(frozen=True)
class Barrier:
    """A relaxed logarithmic barrier before each demand.

    It rises from 0 at `margin_m` of slack like a logarithm, so that climbers slide along what is not allowed
    instead of ending there, and goes on as a parabola where a demand is nearly or not met.

    Args:
        weight: of the barrier against the log posterior.
        margin_m: slack from which on it is 0.
        relaxed_m: slack below which it is a parabola.
    """

    weight: float = 0.1
    margin_m: float = 0.006
    relaxed_m: float = 0.001

    def value(self, slack: Float64[np.ndarray, "s k"]) -> Float64[np.ndarray, "s"]:
        """Log barrier of s grasps, at most 0."""
        ratio = slack.clip(self.relaxed_m, self.margin_m) / self.margin_m
        beyond = np.minimum(slack - self.relaxed_m, 0.0)
        cost = ratio - 1 - np.log(ratio) + self._steepest * beyond + (beyond / self.relaxed_m) ** 2 / 2
        return -self.weight * np.asarray(cost.sum(axis=1))

    def slope(self, slack: Float64[np.ndarray, "s k"]) -> Float64[np.ndarray, "s k"]:
        """Its derivatives by the slack."""
        beyond = np.minimum(slack - self.relaxed_m, 0.0)
        near = 1 / self.margin_m - 1 / slack.clip(self.relaxed_m, self.margin_m)
        return -self.weight * (near + beyond / self.relaxed_m**2)

    @property
    def _steepest(self) -> float:
        return 1 / self.margin_m - 1 / self.relaxed_m


DEFAULT_BARRIER = Barrier()


class ConstrainedObjective(Objective):
    """An objective of which not every grasp is allowed.

    Args:
        objective: what says how good a grasp is.
        constraint: what says whether it is allowed.
        barrier: what keeps climbers away from those that are not.
    """

    def __init__(
        self, objective: Objective, constraint: Constraint, barrier: Barrier = DEFAULT_BARRIER
    ) -> None:
        self._objective, self._constraint, self._barrier = objective, constraint, barrier

    def evaluate(self, theta: Float64[Tensor, "s d"]) -> Evaluation:
        slack = self._constraint.slack(theta.detach().numpy())
        violation = np.maximum(-slack.values.min(axis=1), 0.0)
        barrier: Tensor = _BarrierTerm.apply(theta, slack, self._barrier)  # type: ignore[no-untyped-call]
        evaluation = self._objective.evaluate(theta)
        return replace(evaluation, violation=torch.from_numpy(violation), log_barrier=barrier)


class _BarrierTerm(torch.autograd.Function):
    """The barrier as a function of theta; its gradient is only worked out when someone asks for it."""

    @staticmethod
    def forward(ctx: Any, theta: Tensor, slack: Slack, barrier: Barrier) -> Tensor:
        ctx.slack, ctx.barrier, ctx.shape = slack, barrier, theta.shape
        return torch.from_numpy(barrier.value(slack.values))

    @staticmethod
    def backward(ctx: Any, *outer: Tensor) -> tuple[Tensor, None, None]:
        weights = outer[0].numpy()[:, None] * ctx.barrier.slope(ctx.slack.values)
        gradient = ctx.slack.pull_back(weights) if weights.any() else np.zeros(ctx.shape)
        return torch.from_numpy(gradient), None, None
