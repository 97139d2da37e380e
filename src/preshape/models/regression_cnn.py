"""Regression network: the paper's comparison, which says a grasp outright (section 4.2)."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.models.success_model import IMAGE_CHANNELS, GraspNetwork, xavier_weights
from preshape.perception.view_batch import ViewBatch


class RegressionCNN(GraspNetwork):
    """Predicts one grasp theta from the object's patch alone; 90,934 parameters for d = 14.

    The image channel of config-CNN with a feature map of 13 x 13, then fully connected layers and a linear
    output for each parameter.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
        ridge: weight of the squared output weights in the loss.
    """

    def __init__(
        self, name: str, grasp_space: str, theta_dim: int, *, keep_prob: float = 0.75, ridge: float = 0.5
    ) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.ridge = ridge
        drop = 1.0 - keep_prob
        self.image_channel = nn.Sequential(
            nn.Conv2d(IMAGE_CHANNELS, 32, kernel_size=12, stride=4, padding=4),
            nn.ReLU(),
            nn.Conv2d(32, 8, kernel_size=6, stride=2, padding=2),
            nn.ReLU(),
            nn.MaxPool2d(4, ceil_mode=True),
            nn.Flatten(),
            nn.Linear(8 * 13 * 13, 32),
            nn.ReLU(),
            nn.Dropout(drop),
            nn.Linear(32, 32),
            nn.ReLU(),
            nn.Dropout(drop),
        )
        self.output = nn.Linear(32, theta_dim)
        self.apply(xavier_weights)

    def forward(self, view: ViewBatch) -> Float[Tensor, "b {self.theta_dim}"]:
        """Grasps theta (camera frame, m and rad)."""
        patch = self.normalize_patch(view.patch).contiguous(memory_format=torch.channels_last)
        standardized: Tensor = self.output(self.image_channel(patch))
        return self.theta_mean + self.theta_std * standardized

    def loss(
        self, theta: Float[Tensor, "b {self.theta_dim}"], lifted: Float[Tensor, "b {self.theta_dim}"]
    ) -> Float[Tensor, ""]:
        """Squared errors in standard deviations, summed over the parameters, with ridge regression.

        Args:
            theta: what `forward` predicted.
            lifted: grasps that lifted in these views.
        """
        errors = ((theta - lifted) / self.theta_std).square().sum(dim=1)
        return errors.mean() + self.ridge * self.output.weight.square().sum()
