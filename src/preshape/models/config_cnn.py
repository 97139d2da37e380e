"""config-CNN: the paper's network of an image and a grasp configuration (section 3.1)."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import conv2d

from preshape.hands.projectable import ProjectableHand
from preshape.models.success_model import IMAGE_CHANNELS, SuccessModel, xavier_weights
from preshape.perception.grasp_patches import cut_patches
from preshape.perception.hand_projection import HandProjection
from preshape.perception.view_batch import ViewBatch


class JointInput(NamedTuple):
    """What the convolution with which k begins makes of its two inputs; c = 8 x 13 x 13 values of its map.

    Args:
        of_image: what it makes of m(z), for each of f views.
        of_theta: what it makes of each of the 8 values of n, tiled, where all else is 0.
    """

    of_image: Float[Tensor, "f c"]
    of_theta: Float[Tensor, "8 c"]


class ConfigCNN(SuccessModel):
    """Image and grasp configuration channels that meet on a feature map; 61,065 parameters for d = 14.

    The feature map shrinks 400 -> 100 -> 50 -> 25 in the image channel m and 25 -> 13 -> 7 in the joint
    channel k; all convolutions pad so that a stride s divides the size by s, rounded up.

    The convolution with which k begins is linear, so what it makes of m is added to what it makes of the
    tiled n. The former is computed once for a view. The latter is a matrix, of which the borders alone know
    where they are, times n. The sum is that of the paper, and many grasps in one view cost little.

    The patch is either fixed on the object, or it moves with the palm: centred where the palm appears,
    upright, and cut from the object's patch, beyond which it is 0. Then theta changes the image as well, and
    a gradient has both terms of the paper's equation 4.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
        hand: kinematics of the hand with whose palm the patch moves; None if it is fixed on the object.
    """

    def __init__(
        self,
        name: str,
        grasp_space: str,
        theta_dim: int,
        *,
        keep_prob: float = 0.75,
        hand: ProjectableHand | None = None,
    ) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.projection = None if hand is None else HandProjection(hand)
        drop = 1.0 - keep_prob
        self.image_channel = nn.Sequential(
            nn.Conv2d(IMAGE_CHANNELS, 32, kernel_size=12, stride=4, padding=4),
            nn.ReLU(),
            nn.Conv2d(32, 8, kernel_size=6, stride=2, padding=2),
            nn.ReLU(),
            nn.MaxPool2d(2),
        )
        self.theta_channel = nn.Sequential(nn.Linear(theta_dim, 8), nn.ReLU(), nn.Dropout(drop))
        self.joint_convolution = nn.Conv2d(8 + 8, 8, kernel_size=3, stride=2, padding=1)
        self.joint_channel = nn.Sequential(
            nn.ReLU(),
            nn.MaxPool2d(2, ceil_mode=True),
            nn.Flatten(),
            nn.Linear(8 * 7 * 7, 32),
            nn.ReLU(),
            nn.Dropout(drop),
            nn.Linear(32, 32),
            nn.ReLU(),
            nn.Dropout(drop),
            nn.Linear(32, 1),
        )
        self.apply(xavier_weights)

    def features(self, view: ViewBatch) -> JointInput | ViewBatch:
        """What k makes of m(z) if patches are fixed on the object; the views if they move with the palm."""
        return self._joint_input(view.patch) if self.projection is None else view.to(self.image_mean)

    def raw_head(
        self, features: JointInput | ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]
    ) -> Float[Tensor, "b"]:
        """k(m, n(theta)): logits of b grasps, from the features of b views or of one that they share."""
        if isinstance(features, ViewBatch):
            features = self._joint_input(self._palm_patches(features, theta))
        n = self.theta_channel(self.normalize_theta(theta))
        joint = torch.addmm(features.of_image, n, features.of_theta)
        logits: Tensor = self.joint_channel(joint.view(-1, 8, 13, 13))
        return logits.squeeze(1)

    def _joint_input(self, patch: Float[Tensor, "b 8 400 400"]) -> JointInput:
        # Convolutions of this shape run nearly twice as fast on a CPU with the channels last.
        patch = self.normalize_patch(patch).contiguous(memory_format=torch.channels_last)
        weight, bias = self.joint_convolution.weight, self.joint_convolution.bias
        of_image = conv2d(self.image_channel(patch), weight[:, :8], bias, stride=2, padding=1)
        one_each = torch.eye(8).to(patch).view(8, 8, 1, 1).expand(8, 8, 25, 25)
        of_theta = conv2d(one_each, weight[:, 8:], stride=2, padding=1)
        return JointInput(of_image.flatten(1), of_theta.flatten(1))

    def _palm_patches(self, view: ViewBatch, theta: Float[Tensor, "b d"]) -> Float[Tensor, "b 8 400 400"]:
        assert self.projection is not None
        palm = self.projection(theta, view.intrinsics).palm
        up = palm.new_tensor([[0.0, -1.0]]).expand_as(palm)
        return cut_patches(view.patch, palm[:, None], up, view.patch.shape[-1])[:, 0]
