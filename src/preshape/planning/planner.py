"""What a planner is."""

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from preshape.planning.bounds import Bounds
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult


@runtime_checkable
class Planner(Protocol):
    """Turns initial grasps into better ones.

    A planner maximises the objective, keeps to its bounds exactly, never returns a grasp that the objective
    rates lower than the one it was given, and says why it stopped.
    """

    def plan(self, objective: Objective, initial: Float64[np.ndarray, "s d"], bounds: Bounds) -> PlanResult:
        """Plan from s >= 1 initial grasps, each within its own box (else it is projected first)."""
        ...
