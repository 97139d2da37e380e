"""patches-CNN: the paper's network of image patches at the palm and the fingertips (section 3.2)."""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.models.ensemble import EnsembleModel
from preshape.models.success_model import IMAGE_CHANNELS, xavier_weights
from preshape.perception.finite_differences import with_finite_differences
from preshape.perception.grasp_patches import cut_patches
from preshape.perception.gripper_frame import GripperFrame
from preshape.perception.hand_projection import HandProjection, ProjectedHand
from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.view_batch import ViewBatch

PALM_PATCH = 200
FINGER_PATCH = 100
"""Width and height of the paper's patches in pixels."""
FINGER_KERNELS = (6, 3)
"""Widths of the kernels of the fingers' two convolutions."""
FEATURES = 32
"""Units of each patch's fully connected layer."""
LOOKS = [CHANNEL_NAMES.index(name) for name in ("red", "green", "blue", "curvature")]
"""Channels that are the same in every frame."""


class PatchesCNN(EnsembleModel):
    """A patch at the palm and one at each fingertip, each with a channel of its own.

    Patches are centred where palm and fingertips appear, with the direction of the hand upwards.
    The network learns of theta by these patches alone. With two fingers it has 315,961 parameters as the
    paper's, 319,001 with the joint layer; with four fingers and the joint layer it has 430,761.

    There may be several such networks (`preshape.models.ensemble`), which all see the same patches.

    Args:
        name, grasp_space, theta_dim: see `GraspNetwork`.
        projection: where palm and fingertips of the hand appear in an image.
        joint_layer: whether a fully connected layer comes between the concatenated features and the logit.
        keep_prob: probability with which dropout keeps a unit of the fully connected layers.
        palm_patch, finger_patch: width and height of the patches in pixels of the views.
        palm_kernels: widths of the kernels of the palm's two convolutions; those of the fingers' are
            `FINGER_KERNELS`.
        frame: takes patches into the gripper's own frame, so that a grasp that is turned together with what
            it is at looks the same; None keeps depths and normals of the camera frame, as the paper does.
        difference_steps: steps in theta (its units) of the finite differences by which the paper derives
            patches; None for the exact derivative.
        members: number m of networks; the paper has one.
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
        palm_patch: int = PALM_PATCH,
        finger_patch: int = FINGER_PATCH,
        palm_kernels: Sequence[int] = (12, 6),
        frame: GripperFrame | None = None,
        difference_steps: Sequence[float] | None = None,
        members: int = 1,
    ) -> None:
        super().__init__(name, grasp_space, theta_dim)
        self.projection, self.view_size = projection, projection.view_size
        self.palm_patch, self.finger_patch = palm_patch, finger_patch
        self.frame, self.difference_steps = frame, difference_steps
        if frame is not None:
            self.looks_at = ("patch", "intrinsics", "table")
        channels = IMAGE_CHANNELS if frame is None else len(LOOKS) + frame.channels
        self.members = nn.ModuleList(
            _JoinedPatches(
                _patch_channel(channels, palm_patch, kernels=palm_kernels, drop=1.0 - keep_prob),
                [
                    _patch_channel(channels, finger_patch, kernels=FINGER_KERNELS, drop=1.0 - keep_prob)
                    for _ in range(projection.fingers)
                ],
                joint_layer=joint_layer,
                drop=1.0 - keep_prob,
            )
            for _ in range(members)
        )
        self.apply(xavier_weights)

    def features(self, view: ViewBatch) -> ViewBatch:
        """The views themselves, from which patches are cut."""
        view = view.to(self.image_mean)
        return view if self.frame is None else self.frame.without_holes(view)

    def each(self, features: ViewBatch, theta: Float[Tensor, "b {self.theta_dim}"]) -> Float[Tensor, "m b"]:
        """See `EnsembleModel`."""

        def cut(theta: Tensor) -> tuple[Tensor, ...]:
            return self._patches(features, theta)

        steps = self.difference_steps
        palm, fingers = cut(theta) if steps is None else with_finite_differences(cut, theta, steps)
        prepared = [
            patch.contiguous(memory_format=torch.channels_last) for patch in (palm, *fingers.unbind(dim=1))
        ]
        return torch.stack([member(prepared) for member in self.members])

    def _patches(self, features: ViewBatch, theta: Float[Tensor, "b d"]) -> tuple[Tensor, Tensor]:
        """The palm's patch (b, c, h, w) and the f fingers' (b, f, c, h, w) of each grasp."""
        hand = self.projection(theta, features.intrinsics)
        palms = self._patch(features, hand.palm[:, None], hand, self.palm_patch)
        return palms[:, 0], self._patch(features, hand.fingertips, hand, self.finger_patch)

    def _patch(
        self, view: ViewBatch, centres: Float[Tensor, "b n 2"], hand: ProjectedHand, size: int
    ) -> Float[Tensor, "b n c size size"]:
        """Normalised patches around pixels."""
        patches = cut_patches(view.patch, centres, hand.direction, size)
        looks = self.normalize_patch(patches)
        if self.frame is None:
            return looks
        return torch.cat((looks[:, :, LOOKS], self.frame.surface(view, centres, patches, hand)), dim=2)


class _JoinedPatches(nn.Module):
    """One of the networks: a channel for each patch, and what makes a logit of their features."""

    def __init__(
        self, palm_channel: nn.Module, finger_channels: Sequence[nn.Module], *, joint_layer: bool, drop: float
    ) -> None:
        super().__init__()
        self.palm_channel = palm_channel
        self.finger_channels = nn.ModuleList(finger_channels)
        width = FEATURES * (1 + len(finger_channels))
        layers: list[nn.Module] = []
        if joint_layer:
            layers = [nn.Linear(width, FEATURES), nn.ReLU(), nn.Dropout(drop)]
        self.joint_channel = nn.Sequential(*layers, nn.Linear(FEATURES if joint_layer else width, 1))

    def forward(self, patches: Sequence[Float[Tensor, "b c _ _"]]) -> Float[Tensor, "b"]:
        channels = (self.palm_channel, *self.finger_channels)
        features = [channel(patch) for channel, patch in zip(channels, patches, strict=True)]
        logits: Tensor = self.joint_channel(torch.cat(features, dim=1))
        return logits.squeeze(1)


def _patch_channel(channels: int, size: int, *, kernels: Sequence[int], drop: float) -> nn.Sequential:
    """Two convolutions, pooling and a fully connected layer; each of the first three halves the map."""
    first, second = kernels
    pixels = (-(-_halved(_halved(size, first), second) // 2)) ** 2
    return nn.Sequential(
        nn.Conv2d(channels, 32, first, stride=2, padding=(first - 1) // 2),
        nn.ReLU(),
        nn.Conv2d(32, 8, second, stride=2, padding=(second - 1) // 2),
        nn.ReLU(),
        nn.MaxPool2d(2, ceil_mode=True),
        nn.Flatten(),
        nn.Linear(8 * pixels, FEATURES),
        nn.ReLU(),
        nn.Dropout(drop),
    )


def _halved(size: int, kernel: int) -> int:
    """Size of a map after a convolution with stride 2: half, rounded up if the kernel is odd, else down."""
    return (size + kernel % 2) // 2
