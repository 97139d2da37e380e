"""Which prior over theta a planner takes."""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from preshape.errors import InputError
from preshape.grasps.space import GraspSpace
from preshape.perception.view_batch import ViewBatch
from preshape.planning.mixture_density_network import MixtureDensityNetwork
from preshape.planning.objective import Objective
from preshape.planning.prior import GraspPrior, PriorObjective


@dataclass(frozen=True)
class PriorChoice:
    """Which prior a planner takes, and how much it counts.

    Args:
        file: what `python src/fit_prior.py` wrote; None for the paper's uniform prior.
        weight: of the log prior against the log probability of success; 0 for the paper's maximum likelihood.

    Raises:
        InputError: if the weight is not 0 and there is no file.
    """

    file: str | None = None
    weight: float = 0.0

    def __post_init__(self) -> None:
        if self.weight and self.file is None:
            raise InputError(
                "A prior has a weight, but no file",
                where="prior.file",
                fix="fit one with `python src/fit_prior.py`, or set prior.weight=0",
            )

    def joined_to(
        self,
        objective: Objective,
        space: GraspSpace,
        view: ViewBatch,
        T_camera_box: Float[np.ndarray, "4 4"],
    ) -> Objective:
        """The objective with the prior of grasps of an object beside it.

        Args:
            objective: gives the probability of success.
            space: what theta means.
            view: the object, one in the batch.
            T_camera_box: pose of its bounding box, in double precision.

        Raises:
            InputError: if the prior cannot be read, or is for another grasp space.
        """
        if self.file is None or not self.weight:
            return objective
        prior = read_prior(self.file)
        if prior.grasp_space != space.name:
            raise InputError(
                f"The prior is for grasp space {prior.grasp_space!r}, not for {space.name!r}",
                where=self.file,
                fix="choose the robot whose grasps it was fitted to",
            )
        return PriorObjective(objective, prior.in_view(view), T_camera_box, self.weight)


def read_prior(path: str | Path) -> GraspPrior | MixtureDensityNetwork:
    """The prior in a file, of whichever kind.

    Raises:
        InputError: if the file is missing, damaged, or no prior of this version.
    """
    start = b""
    with suppress(OSError), Path(path).open("rb") as file:
        start = file.read(8)
    # Safetensors begin with a length in 8 bytes, of which the highest are 0; no JSON text holds such a byte.
    return MixtureDensityNetwork.read(path) if 0 in start else GraspPrior.read(path)
