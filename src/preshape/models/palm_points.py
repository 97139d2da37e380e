"""Palm points: a network that sees the object's points as the palm would."""

from functools import partial

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import normalize

from preshape.geometry.pose import rotation_from_euler_xyz
from preshape.models.ensemble import EnsembleModel, MemberLinear
from preshape.perception.view_batch import ViewBatch

LENGTH_M = 0.1
"""Unit of lengths inside the network, about the size of a hand."""
SURROUNDINGS = 7
"""Up, line of sight and height over the table: what is known of a grasp besides points and joints."""


class PalmPoints(EnsembleModel):
    """Points of the object in the frame of the palm, pooled by their maximum; 55,045 parameters for d = 14.

    Whether a grasp lifts depends on where the object is relative to the hand, and not on where both are in
    the image. So the points p of the object's visible surface are taken into the palm's frame,
    q = R(theta)^T (p - t(theta)), each goes through the same layers, which also know the joints, and the
    maximum over all points goes on (Qi et al., "PointNet", CVPR 2017). Beside it go the joints, the palm's
    height over the table, and the directions of up and of the camera in the palm's frame. All that is a
    smooth function of theta, so that gradients with respect to a grasp are exact and cheap. Colours are not
    looked at.

    There are several such networks (`preshape.models.ensemble`), which all see the same. In training each
    batch sees another random part of the points.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
        points: number of points that are looked at.
        width: units of the first layer of each point; the second has twice as many.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
        members: number m of networks.
    """

    looks_at = ("points", "table")

    def __init__(
        self,
        name: str,
        grasp_space: str,
        theta_dim: int,
        *,
        points: int = 128,
        width: int = 32,
        keep_prob: float = 0.9,
        members: int = 5,
    ) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.points = points
        drop = 1.0 - keep_prob
        context = theta_dim - 6 + SURROUNDINGS
        layer = partial(MemberLinear, members)
        self.context_channel = nn.Sequential(layer(context, 32), nn.ReLU(), layer(32, width))
        self.point_channel = layer(3, width, bias=False)
        self.pooled_channel = layer(width, 2 * width, bias=False)
        self.pooled_bias = nn.Parameter(torch.zeros(members, 1, 2 * width))
        self.joint_channel = nn.Sequential(
            layer(2 * width + context, 64),
            nn.ReLU(),
            nn.Dropout(drop),
            layer(64, 32),
            nn.ReLU(),
            nn.Dropout(drop),
            layer(32, 1),
        )

    def features(self, view: ViewBatch) -> ViewBatch:
        """The views with the points that are looked at."""
        total = view.points.shape[1]
        chosen = torch.randperm(total)[: self.points] if self.training else slice(self.points)
        return view._replace(points=view.points[:, chosen]).to(self.theta_mean)

    def each(self, features: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "m b"]:
        """See `EnsembleModel`."""
        palm, rotation = theta[:, :3], rotation_from_euler_xyz(theta[:, 3:6])
        context = self._context(features.table, theta, rotation)
        # W q + c of all points p, with W q = W R^T p - W R^T t: points of a shared view are not copied.
        turned = self.point_channel.weight[:, None] @ rotation.mT / LENGTH_M
        moved = self.context_channel(context) - (turned @ palm[..., None])[..., 0]
        each = torch.relu(features.points @ turned.mT + moved[:, :, None])
        # Bias and ReLU keep the order, so they can wait for the maximum, which leaves them less to do.
        highest = (each @ self.pooled_channel.weight.mT[:, None]).amax(dim=2)
        pooled = torch.relu(highest + self.pooled_bias)
        known = torch.cat((pooled, context.expand(len(pooled), -1, -1)), dim=2)
        logits: Tensor = self.joint_channel(known)
        return logits.squeeze(2)

    def _context(
        self, table: Float[Tensor, "f 4"], theta: Float[Tensor, "b d"], rotation: Float[Tensor, "b 3 3"]
    ) -> Float[Tensor, "b c"]:
        """Joints, height over the table, and up and the way to the camera in the palm's frame."""
        palm, up = theta[:, :3], table[:, :3].expand(len(theta), -1)
        height = ((palm * up).sum(dim=1) + table[:, 3]) / LENGTH_M
        directions = torch.stack((up, normalize(-palm, dim=1)), dim=1) @ rotation
        return torch.cat((self.normalize_theta(theta)[:, 6:], height[:, None], directions.flatten(1)), dim=1)
