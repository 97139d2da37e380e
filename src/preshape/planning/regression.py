"""The regression baseline: a network says one grasp outright (paper, section 4.2)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float64

from preshape.errors import InputError
from preshape.models.checkpoints import load_weights
from preshape.models.regression_cnn import RegressionCNN
from preshape.perception.view_batch import ViewBatch


@dataclass(frozen=True, eq=False)
class RegressedGrasp:
    """Says one grasp instead of the heuristic ones.

    Args:
        network: what says it; its weights are read here, because it is another network than the one that
            predicts success.
        weights: its trained weights.
    """

    network: RegressionCNN
    weights: str | Path | None

    def grasp(self, view: ViewBatch) -> Float64[np.ndarray, "d"]:
        """The grasp theta for a view, which may lie outside of all bounds.

        Raises:
            InputError: if there are no weights, or they cannot be used.
        """
        if self.weights is None:
            raise InputError(
                "The planner `regression` has no network",
                where="weights of its proposer",
                fix="train one with `python src/train.py model=regression`, and set planner.proposer.weights",
            )
        load_weights(self.weights, self.network)
        with torch.no_grad():
            theta = self.network(view.to(next(self.network.parameters())))
        return np.asarray(theta[0].double().cpu().numpy())
