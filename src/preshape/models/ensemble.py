"""Several networks of the same shape side by side, whose probabilities are averaged.

Each learns by itself from its own initial weights (Lakshminarayanan et al., "Simple and scalable predictive
uncertainty estimation using deep ensembles", NeurIPS 2017). A grasp that one of them overrates by accident
seldom deceives the others, which matters where a planner looks for just such grasps.
"""

from abc import abstractmethod
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import logsigmoid

from preshape.models.success_model import SuccessModel
from preshape.perception.view_batch import ViewBatch


class EnsembleModel(SuccessModel):
    """Several networks in one, which learn by themselves and predict the mean of their probabilities."""

    @abstractmethod
    def each(self, features: Any, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "m b"]:
        """Logits of b grasps by each of the m networks, from b views or from one that they share."""

    def raw_head(self, features: Any, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "b"]:
        """Logits of b grasps before calibration, from b views or from one that they share."""
        return logit_of_mean(self.each(features, theta))

    def member_logits(
        self, view: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]
    ) -> Float[Tensor, "m b"]:
        """Logits of b grasps, each in its own view, by each of the m networks, before calibration."""
        return self.each(self.features(view), theta)


class MemberLinear(nn.Module):
    """A linear layer of each of m networks, with Xavier weights and zero biases, in one product of matrices.

    Args:
        members: number m of networks.
        inputs, outputs: numbers of units.
        bias: whether there are biases.
    """

    def __init__(self, members: int, inputs: int, outputs: int, *, bias: bool = True) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.empty(members, outputs, inputs))
        self.bias = nn.Parameter(torch.zeros(members, 1, outputs)) if bias else None
        for weight in self.weight:
            nn.init.xavier_uniform_(weight)

    def forward(self, values: Float[Tensor, "*m b i"]) -> Float[Tensor, "m b o"]:
        """Outputs of all members, from inputs of each or from such that they share."""
        outputs = values @ self.weight.mT
        return outputs if self.bias is None else outputs + self.bias


def logit_of_mean(logits: Float[Tensor, "m b"]) -> Float[Tensor, "b"]:
    """Log odds of the mean of m probabilities, from the log odds of each."""
    return logsigmoid(logits).logsumexp(dim=0) - logsigmoid(-logits).logsumexp(dim=0)
