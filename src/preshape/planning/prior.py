"""What good grasps look like before any network has looked: a prior over theta, for MAP planning."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Float64
from torch import Tensor

from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.geometry.pose import rotation_from_euler_xyz
from preshape.perception.view_batch import ViewBatch
from preshape.planning.objective import Evaluation, Objective

FORMAT = "preshape-prior/1"
"""Name and version of the file; raised whenever old files could be misread."""
POSITION_M, DIRECTION, JOINT_RAD = 0.05, 0.3, 0.2
"""Units in which a mixture sees the palm's position, its axes, and the preshape joints."""
MIN_VARIANCE = 0.01
"""Added to every variance of a mixture in these units, for joints that the heuristic does not move."""
PARTS = ("log_weights", "means", "precisions")


def in_box(theta: Float64[Tensor, "s d"], T_camera_box: Float64[Tensor, "#s 4 4"]) -> Float64[Tensor, "s e"]:
    """Grasps as the object's bounding box sees them; differentiable in theta.

    Theta's palm pose is in the camera frame, where grasps of the same kind differ with every place and turn
    of the object. The palm's position is taken from the centre of the box, along its axes; its rotation as
    the directions of its x and z axes, which, unlike angles, have no jumps.
    """
    rotation = T_camera_box[:, :3, :3]
    position = (theta[:, None, :3] - T_camera_box[:, None, :3, 3]) @ rotation
    axes = rotation.mT @ rotation_from_euler_xyz(theta[:, 3:6])
    parts = (
        position[:, 0] / POSITION_M,
        axes[:, :, 0] / DIRECTION,
        axes[:, :, 2] / DIRECTION,
        theta[:, 6:] / JOINT_RAD,
    )
    return torch.cat(parts, dim=1)


@dataclass(frozen=True, eq=False)
class GraspPrior:
    """A mixture of m normal distributions over grasps in the frame of the object's box.

    Args:
        grasp_space: name of the grasp space of theta.
        log_weights: logarithms of the weights of the distributions.
        means: their means, see `in_box`.
        precisions: upper triangular U of each, U U^T being its inverse covariance.
    """

    grasp_space: str
    log_weights: Float64[Tensor, "m"]
    means: Float64[Tensor, "m e"]
    precisions: Float64[Tensor, "m e e"]

    def log_density(
        self, theta: Float64[Tensor, "s d"], T_camera_box: Float64[Tensor, "#s 4 4"]
    ) -> Float64[Tensor, "s"]:
        """Log density of grasps around one box or each its own, up to a constant; differentiable."""
        offsets = in_box(theta, T_camera_box)[:, None] - self.means
        whitened = (offsets[:, :, None] @ self.precisions)[:, :, 0]
        log_volume = self.precisions.diagonal(dim1=1, dim2=2).log().sum(dim=1)
        return torch.logsumexp(self.log_weights + log_volume - whitened.square().sum(dim=2) / 2, dim=1)

    def in_view(self, view: ViewBatch) -> "GraspPrior":
        """What it says of the object in a view: the same of every object."""
        return self

    def write(self, path: str | Path) -> None:
        """Write the prior as JSON, atomically.

        Raises:
            InputError: if the place cannot be written to.
        """
        parts = {name: getattr(self, name).numpy() for name in PARTS}
        write_json(path, {"format": FORMAT, "grasp_space": self.grasp_space} | parts)

    @classmethod
    def read(cls, path: str | Path) -> "GraspPrior":
        """Read a prior.

        Raises:
            InputError: if the file is missing, damaged, or no prior of this version.
        """
        content = read_json(path)
        again = "fit it again with `python src/fit_prior.py`"
        if content.get("format") != FORMAT:
            raise InputError(f"The file is no prior in the format {FORMAT}", where=path, fix=again)
        try:
            parts = [torch.tensor(content[name], dtype=torch.float64) for name in PARTS]
            size = parts[1].shape[1]
            shapes = ((len(parts[0]),), (len(parts[0]), size), (len(parts[0]), size, size))
            if tuple(tuple(part.shape) for part in parts) != shapes:
                raise ValueError("its parts do not fit together")
            if not all(part.isfinite().all() for part in parts):
                raise ValueError("it holds NaN or infinity")
            return cls(str(content["grasp_space"]), *parts)
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise InputError(
                f"The prior is incomplete or damaged ({error})", where=path, fix=again
            ) from error


class PriorObjective(Objective):
    """An objective with a prior over theta beside it: what MAP planning climbs (paper, section 2).

    Args:
        objective: gives the probability of success.
        prior: the prior.
        T_camera_box: pose of the object's bounding box.
        weight: of the log prior.
    """

    def __init__(
        self,
        objective: Objective,
        prior: GraspPrior,
        T_camera_box: Float[np.ndarray, "4 4"],
        weight: float,
    ) -> None:
        self._objective, self._prior, self._weight = objective, prior, weight
        self._box = torch.from_numpy(T_camera_box)[None]

    def evaluate(self, theta: Float64[Tensor, "s d"]) -> Evaluation:
        evaluation = self._objective.evaluate(theta)
        return replace(evaluation, log_prior=self._weight * self._prior.log_density(theta, self._box))
