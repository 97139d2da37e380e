"""What the networks have in common: what they see, what theta means to them, how inputs are normalised."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.perception.object_view import PATCH_SIZE
from preshape.perception.view_batch import ViewBatch

IMAGE_CHANNELS = 8
"""Channels of the image: RGB, depth, normal xyz, curvature."""
MIN_IMAGE_STD = 1e-3
"""Floor of a channel's standard deviation, so that a constant channel is not blown up."""
MIN_THETA_STD = 0.05
"""Floor of a parameter's standard deviation (m or rad), for joints that the heuristic hardly moves."""


class GraspNetwork(nn.Module):
    """A network that sees objects and knows a grasp space.

    The statistics that normalise its inputs are buffers, so they travel with the weights.

    Args:
        name: name of the network, compared with that of a weights file.
        grasp_space: name of the grasp space of theta.
        theta_dim: number d of its parameters.

    Attributes:
        looks_at: the parts of a `ViewBatch` that it looks at.
        view_size: height and width of the views' images (pixels).
    """

    looks_at: tuple[str, ...] = ("patch", "intrinsics")
    view_size = (PATCH_SIZE, PATCH_SIZE)
    image_mean: Tensor
    image_std: Tensor
    theta_mean: Tensor
    theta_std: Tensor

    def __init__(self, name: str, grasp_space: str, theta_dim: int) -> None:
        super().__init__()
        self.name = name
        self.grasp_space = grasp_space
        self.theta_dim = theta_dim
        self.register_buffer("image_mean", torch.zeros(IMAGE_CHANNELS))
        self.register_buffer("image_std", torch.ones(IMAGE_CHANNELS))
        self.register_buffer("theta_mean", torch.zeros(theta_dim))
        self.register_buffer("theta_std", torch.ones(theta_dim))

    def fit_statistics(self, patches: Iterable[Tensor], theta: Float[Tensor, "n d"]) -> None:
        """Set the normalisation from training data.

        Args:
            patches: patches (8, h, w) of the training scenes; values that are not finite are left out.
            theta: grasp configurations of the training trials.
        """
        if "patch" in self.looks_at:
            mean, std = channel_statistics(patches)
            self.image_mean.copy_(mean)
            self.image_std.copy_(std.clamp_min(MIN_IMAGE_STD))
        finite = theta[theta.isfinite().all(dim=1)].double()
        self.theta_mean.copy_(finite.mean(dim=0))
        self.theta_std.copy_(finite.std(dim=0, correction=0).clamp_min(MIN_THETA_STD))

    def normalize_patch(self, patch: Float[Tensor, "*b 8 h w"]) -> Float[Tensor, "*b 8 h w"]:
        """Patches with zero mean and unit deviation per channel over the training data.

        Patches in half precision, as they are cached, become single precision on the way.
        """
        values = patch.to(self.image_mean.dtype, copy=True)
        return values.sub_(self.image_mean.view(-1, 1, 1)).div_(self.image_std.view(-1, 1, 1))

    def normalize_theta(self, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b d"]:
        """Configurations with zero mean and unit deviation per parameter over the training data."""
        return (theta - self.theta_mean) / self.theta_std


class SuccessModel(GraspNetwork, ABC):
    """A network for log odds of p(Y = 1 | theta, z), the probability that a grasp lifts the object.

    f = k(m(z), n(theta)) of the paper's section 3.1 is split into `features` = m, which a planner computes
    once per view, and `head` = k(., n(.)), which it evaluates and differentiates again and again.

    The logits are calibrated: what the network itself says (`raw_head`) is moved by `logit_shift` and divided
    by `temperature`. Both are buffers, so they travel with the weights; while a network is trained they are
    0 and 1 and change nothing.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
    """

    logit_shift: Tensor
    temperature: Tensor

    def __init__(self, name: str, grasp_space: str, theta_dim: int) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.register_buffer("logit_shift", torch.zeros(()))
        self.register_buffer("temperature", torch.ones(()))

    @abstractmethod
    def features(self, view: ViewBatch) -> Any:
        """What can be said about views without a grasp, in the form that `head` takes."""

    @abstractmethod
    def raw_head(self, features: Any, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "b"]:
        """Logits of b grasps before calibration, from the features of b views, or of one that they share."""

    def head(self, features: Any, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "b"]:
        """Logits of b grasps, from the features of b views, or of the one view that they all share."""
        return (self.raw_head(features, theta) + self.logit_shift) / self.temperature

    def forward(self, view: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "b"]:
        """Logits of grasps theta (camera frame, m and rad), each in its own view."""
        return self.head(self.features(view), theta)

    def member_logits(
        self, view: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]
    ) -> Float[Tensor, "m b"]:
        """Logits before calibration of each of the m networks that this one consists of, to learn from."""
        return self.raw_head(self.features(view), theta)[None]

    def calibrate(self, *, logit_shift: float, temperature: float) -> None:
        """Set how logits are moved, and then divided, from now on."""
        self.logit_shift.fill_(logit_shift)
        self.temperature.fill_(temperature)


def xavier_weights(layer: nn.Module) -> None:
    """Xavier weights and zero biases, for `nn.Module.apply`."""
    if isinstance(layer, nn.Conv2d | nn.Linear):
        nn.init.xavier_uniform_(layer.weight)
        if layer.bias is not None:
            nn.init.zeros_(layer.bias)


def channel_statistics(patches: Iterable[Tensor]) -> tuple[Float[Tensor, "c"], Float[Tensor, "c"]]:
    """Mean and standard deviation per channel over the finite values of patches (c, h, w)."""
    count, total, squares = torch.zeros(3, IMAGE_CHANNELS, dtype=torch.float64).unbind()
    for patch in patches:
        values = patch.flatten(1).float()
        count += values.isfinite().sum(dim=1)
        known = values.nan_to_num(nan=0.0, posinf=0.0, neginf=0.0)
        total += known.sum(dim=1)
        squares += torch.linalg.vector_norm(known, dim=1).double().square()
    mean = total / count.clamp_min(1)
    return mean, (squares / count.clamp_min(1) - mean.square()).clamp_min(0).sqrt()
