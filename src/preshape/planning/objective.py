"""What planners climb: the log posterior of a grasp, log p(success | theta, z) + log p(theta)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import torch
from jaxtyping import Float, Float64
from torch import Tensor
from torch.nn.functional import logsigmoid

from preshape.models.success_model import SuccessModel
from preshape.perception.view_batch import ViewBatch


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What an objective says about s grasps, in float64, differentiable with respect to theta.

    Args:
        logit: log odds of success given by the network.
        log_prior: log density of the prior over theta, up to a constant; zeros for a uniform prior.
        violation: how far (m) a grasp is from what is allowed; zeros where it is allowed.
        log_barrier: keeps climbers away from what is not allowed: at most 0, and 0 at some distance.
    """

    logit: Float64[Tensor, "s"]
    log_prior: Float64[Tensor, "s"]
    violation: Float64[Tensor, "s"]
    log_barrier: Float64[Tensor, "s"]

    @classmethod
    def of(cls, logit: Float64[Tensor, "s"], log_prior: Float64[Tensor, "s"] | None = None) -> "Evaluation":
        """Everything is allowed, and the prior uniform unless given."""
        free = torch.zeros_like(logit)
        return cls(logit, free if log_prior is None else log_prior, free, free)

    @property
    def success_prob(self) -> Float64[Tensor, "s"]:
        """p(success | theta, z)."""
        return torch.sigmoid(self.logit)

    @property
    def log_posterior(self) -> Float64[Tensor, "s"]:
        """log p(success | theta, z) + log p(theta), up to a constant."""
        return logsigmoid(self.logit) + self.log_prior


class Objective(ABC):
    """The log posterior of grasps in one view (paper, equation 1, with a prior over theta beside it)."""

    @abstractmethod
    def evaluate(self, theta: Float[Tensor, "s d"]) -> Evaluation:
        """Logits and log prior of s grasps, each by itself: one row never influences another."""

    def __call__(self, theta: Float[Tensor, "s d"]) -> Float64[Tensor, "s"]:
        """Log posterior of s grasps, differentiable."""
        return self.evaluate(theta).log_posterior

    def success_prob(self, theta: Float[Tensor, "s d"]) -> Float64[Tensor, "s"]:
        """p(success | theta, z) of s grasps, differentiable."""
        return self.evaluate(theta).success_prob


class SuccessObjective(Objective):
    """The learned success probability in one view, with a uniform prior: the paper's objective.

    What the network says of the view alone is computed once. If its patch stays where it is while theta
    moves, the gradient is the paper's dk/dn dn/dtheta (section 3.4, equation 4 without its second term).

    Args:
        model: a trained network; it is put into evaluation mode, its weights get no gradients.
        view: the object's patch, one in the batch.
    """

    def __init__(self, model: SuccessModel, view: ViewBatch) -> None:
        self._model = model.eval()
        weights = next(model.parameters())
        with torch.no_grad():
            self._features = model.features(view.to(weights))
        self._dtype, self._device = weights.dtype, weights.device

    def evaluate(self, theta: Float[Tensor, "s d"]) -> Evaluation:
        logit = self._model.head(self._features, theta.to(self._device, self._dtype))
        logit = logit.to(theta.device, torch.float64)
        return Evaluation.of(logit)


class UnknownSuccess(Objective):
    """Stands in where no network was given: nothing is known about any grasp, so its logit is NaN."""

    def evaluate(self, theta: Float[Tensor, "s d"]) -> Evaluation:
        unknown = torch.full(theta.shape[:1], torch.nan, dtype=torch.float64)
        return Evaluation.of(unknown)
