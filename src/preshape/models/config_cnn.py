"""config-CNN: the paper's network of an image and a grasp configuration (section 3.1)."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.models.success_model import IMAGE_CHANNELS, SuccessModel


class ConfigCNN(SuccessModel):
    """Image and grasp configuration channels that meet on a feature map; 61,065 parameters for d = 14.

    The feature map shrinks 400 -> 100 -> 50 -> 25 in the image channel m and 25 -> 13 -> 7 in the joint
    channel k; all convolutions pad so that a stride s divides the size by s, rounded up.

    Args:
        name, grasp_space, theta_dim: see `SuccessModel`.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
    """

    def __init__(self, name: str, grasp_space: str, theta_dim: int, *, keep_prob: float = 0.75) -> None:
        super().__init__(name, grasp_space, theta_dim)
        drop = 1.0 - keep_prob
        self.image_channel = nn.Sequential(
            nn.Conv2d(IMAGE_CHANNELS, 32, kernel_size=12, stride=4, padding=4),
            nn.ReLU(),
            nn.Conv2d(32, 8, kernel_size=6, stride=2, padding=2),
            nn.ReLU(),
            nn.MaxPool2d(2),
        )
        self.theta_channel = nn.Sequential(nn.Linear(theta_dim, 8), nn.ReLU(), nn.Dropout(drop))
        self.joint_channel = nn.Sequential(
            nn.Conv2d(8 + 8, 8, kernel_size=3, stride=2, padding=1),
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
        self.apply(_initialize)

    def features(self, patch: Float[Tensor, "b 8 400 400"]) -> Float[Tensor, "b 8 25 25"]:
        """m(z): features of object patches."""
        # Convolutions of this shape run nearly twice as fast on a CPU with the channels last.
        patch = self.normalize_patch(patch).contiguous(memory_format=torch.channels_last)
        features: Tensor = self.image_channel(patch)
        return features

    def head(
        self, features: Float[Tensor, "f 8 25 25"], theta: Float[Tensor, "b {self.theta_dim}"]
    ) -> Float[Tensor, "b"]:
        """k(m, n(theta)): logits of b grasps, from b feature maps or from one that they share."""
        batch = theta.shape[0]
        tiled = self.theta_channel(self.normalize_theta(theta))[:, :, None, None]
        joint = torch.cat(
            (features.expand(batch, -1, -1, -1), tiled.expand(-1, -1, *features.shape[2:])), dim=1
        )
        logits: Tensor = self.joint_channel(joint)
        return logits.squeeze(1)


def _initialize(layer: nn.Module) -> None:
    """Xavier weights and zero biases."""
    if isinstance(layer, nn.Conv2d | nn.Linear):
        nn.init.xavier_uniform_(layer.weight)
        assert layer.bias is not None
        nn.init.zeros_(layer.bias)
