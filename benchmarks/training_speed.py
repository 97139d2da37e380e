"""A training step of config-CNN with the image channels last in memory, against channels first."""

from collections.abc import Callable

import torch
from comparison import Comparison, side_by_side
from noise_views import noise_views
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from preshape.models.config_cnn import ConfigCNN

BATCH, RUNS = 8, 7


def channels_last_training(seed: int, flop_per_s: float) -> Comparison:
    """Forward, backward and an Adam step on a batch of the paper's size."""
    generator = torch.Generator().manual_seed(seed)
    view = noise_views(BATCH, generator)
    theta = torch.randn(BATCH, 14, generator=generator)
    label = torch.arange(BATCH).remainder(2).float()

    def step_of(channels_last: bool) -> Callable[[], None]:
        torch.manual_seed(seed)
        model = ConfigCNN("config_cnn", "benchmark", 14)
        if channels_last:
            model = model.to(memory_format=torch.channels_last)
        optimizer = torch.optim.Adam(model.parameters())

        def logits() -> Tensor:
            if channels_last:
                return model(view, theta)
            return model.head(model.image_channel(model.normalize_patch(view.patch)), theta)

        def step() -> None:
            optimizer.zero_grad()
            binary_cross_entropy_with_logits(logits(), label).backward()
            optimizer.step()

        return step

    return side_by_side(
        f"training step of config-CNN, batch {BATCH}, channels last",
        step_of(channels_last=True),
        "channels first",
        step_of(channels_last=False),
        RUNS,
        flop_per_s,
    )
