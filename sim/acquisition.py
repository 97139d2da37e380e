"""Which grasps to execute for the sake of learning, where it is not the planner's own optima."""

from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Literal

import numpy as np
import torch
from jaxtyping import Float, Float64
from torch import Tensor
from torch.nn.functional import logsigmoid

from preshape.planning.bounds import Bounds
from preshape.planning.objective import Evaluation, Objective
from preshape.planning.result import PlanResult
from preshape.planning.sampling import SamplingPlanner

Wanted = Literal["any", "uncertain"]


@dataclass(frozen=True)
class RandomAcquisition:
    """Draws grasps around each initial one and keeps one of those that are allowed.

    It is called like a planner, but looks for grasps to learn from rather than for good ones.

    Args:
        draws: grasps drawn for each initial one, which competes, too.
        wanted: `any` for an even choice, `uncertain` for the probability that is closest to one half.
    """

    draws: int
    wanted: Wanted

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """As `Planner`; the same initial grasps give the same draws, other ones give others."""
        seed = int.from_bytes(sha256(initial.tobytes()).digest()[:4], "big")
        method = SamplingPlanner(self.draws, seed)
        return method.plan(PreferenceObjective(objective, self.wanted, seed), initial, bounds)


class PreferenceObjective(Objective):
    """An objective whose log posterior says how much a grasp is wanted; its probability stays what it is.

    Args:
        objective: what says how likely success is, and what is allowed.
        wanted: see `RandomAcquisition`.
        seed: of the even choice.
    """

    def __init__(self, objective: Objective, wanted: Wanted, seed: int) -> None:
        self._objective, self._wanted = objective, wanted
        self._generator = torch.Generator().manual_seed(seed)

    def evaluate(self, theta: Float[Tensor, "s d"]) -> Evaluation:
        """As `Objective`, with the preference in the place of the log posterior."""
        said = self._objective.evaluate(theta)
        if self._wanted == "any":
            preference = torch.rand(len(theta), generator=self._generator, dtype=torch.float64)
        else:
            preference = -said.logit.abs()
        return replace(said, log_prior=preference - logsigmoid(said.logit))
