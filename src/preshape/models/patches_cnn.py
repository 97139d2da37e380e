"""patches-CNN: the paper's network of image patches at the palm and the fingertips (section 3.2)."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.models.success_model import IMAGE_CHANNELS, SuccessModel, xavier_weights
from preshape.perception.grasp_patches import cut_patches
from preshape.perception.hand_projection import HandProjection
from preshape.perception.view_batch import ViewBatch

PALM_PATCH = 200
FINGER_PATCH = 100
"""Width and height of the patches in pixels."""
FEATURES = 32
"""Units of each patch's fully connected layer."""


class PatchesCNN(SuccessModel):
    """A patch at the palm and one at each fingertip, each with a channel of its own.

    Patches are centred where palm and fingertips appear, with the direction of the palm's fingers upwards.
    The network learns of theta by these patches alone. With two fingers it has 315,961 parameters as the
    paper's, 319,001 with the joint layer; with four fingers and the joint layer it has 430,761.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
        projection: where palm and fingertips of the hand appear in an image.
        joint_layer: whether a fully connected layer comes between the concatenated features and the logit.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
    """

    def __init__(
        self,
        name: str,
        grasp_space: str,
        theta_dim: int,
        *,
        projection: HandProjection,
        joint_layer: bool = True,
        keep_prob: float = 0.75,
    ) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.projection = projection
        drop = 1.0 - keep_prob
        self.palm_channel = _patch_channel(PALM_PATCH, kernels=(12, 6), drop=drop)
        self.finger_channels = nn.ModuleList(
            _patch_channel(FINGER_PATCH, kernels=(6, 3), drop=drop) for _ in range(projection.fingers)
        )
        width = FEATURES * (1 + projection.fingers)
        layers: list[nn.Module] = []
        if joint_layer:
            layers = [nn.Linear(width, FEATURES), nn.ReLU(), nn.Dropout(drop)]
        self.joint_channel = nn.Sequential(*layers, nn.Linear(FEATURES if joint_layer else width, 1))
        self.apply(xavier_weights)

    def features(self, view: ViewBatch) -> ViewBatch:
        """The views themselves, from which patches are cut."""
        return view.to(self.image_mean)

    def raw_head(self, features: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "b"]:
        """Logits of b grasps, from b views or from one that they share."""
        hand = self.projection(theta, features.intrinsics)
        palms = cut_patches(features.patch, hand.palm[:, None], hand.direction, PALM_PATCH)
        fingers = cut_patches(features.patch, hand.fingertips, hand.direction, FINGER_PATCH)
        parts = [self.palm_channel(self._prepared(palms[:, 0]))]
        parts += [
            channel(self._prepared(fingers[:, finger])) for finger, channel in enumerate(self.finger_channels)
        ]
        logits: Tensor = self.joint_channel(torch.cat(parts, dim=1))
        return logits.squeeze(1)

    def _prepared(self, patch: Float[Tensor, "b 8 h w"]) -> Float[Tensor, "b 8 h w"]:
        return self.normalize_patch(patch).contiguous(memory_format=torch.channels_last)


def _patch_channel(size: int, *, kernels: tuple[int, int], drop: float) -> nn.Sequential:
    """Two convolutions, pooling and a fully connected layer; the map shrinks by 8, rounded up."""
    first, second = kernels
    pixels = (-(-size // 8)) ** 2
    return nn.Sequential(
        nn.Conv2d(IMAGE_CHANNELS, 32, first, stride=2, padding=(first - 1) // 2),
        nn.ReLU(),
        nn.Conv2d(32, 8, second, stride=2, padding=(second - 1) // 2),
        nn.ReLU(),
        nn.MaxPool2d(2, ceil_mode=True),
        nn.Flatten(),
        nn.Linear(8 * pixels, FEATURES),
        nn.ReLU(),
        nn.Dropout(drop),
    )
