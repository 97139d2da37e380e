"""Training steps: their arithmetic, the layout of images in memory, and the share of reading the data."""

import tempfile
from collections.abc import Callable
from dataclasses import replace

import torch
from comparison import Comparison, side_by_side
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from noise_views import noise_views
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.command_line.allocator import keep_freed_memory
from preshape.models.config_cnn import ConfigCNN
from preshape.models.lightning_module import learning_of
from preshape.paths import project_root

BATCH, RUNS = 8, 7
TRIALS = 120


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
            image = model.image_channel(model.normalize_patch(view.patch))
            grasp = model.theta_channel(model.normalize_theta(theta))
            tiled = grasp[:, :, None, None].expand(-1, -1, *image.shape[2:])
            joined = model.joint_convolution(torch.cat((image, tiled), dim=1))
            return model.joint_channel(joined).squeeze(1)

        def step() -> None:
            optimizer.zero_grad()
            binary_cross_entropy_with_logits(logits(), label).backward()
            optimizer.step()

        return step

    return side_by_side(
        f"training step of config-CNN, batch {BATCH}, channels last, grasps not tiled",
        step_of(channels_last=True),
        "channels first, grasps tiled as in the paper",
        step_of(channels_last=False),
        RUNS,
        flop_per_s,
    )


def palm_points_step(seed: int, flop_per_s: float) -> Comparison:
    """A step of the default network, on a batch of its own size, and the reading of that batch."""
    return _step_and_reading("palm_points", seed, flop_per_s)


def config_cnn_step(seed: int, flop_per_s: float) -> Comparison:
    """A step of the paper's network, and the reading of its batch from the cache."""
    return _step_and_reading("config_cnn", seed, flop_per_s)


def _step_and_reading(model: str, seed: int, flop_per_s: float) -> Comparison:
    """A training step on shipped trials; beside it the reading of its batch, which a training adds to it."""
    keep_freed_memory()  # as a training does
    with tempfile.TemporaryDirectory() as cache:
        overrides = [f"model={model}", f"paths.cache={cache}", f"dataset.data.trials={TRIALS}"]
        with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
            cfg = compose("train", overrides)
        torch.manual_seed(seed)
        data, network = instantiate(cfg.dataset.data), instantiate(cfg.model)
        data.setup()
        data.render(with_patches="patch" in network.looks_at)
        learning = learning_of(network, instantiate(cfg.learning.settings))
        optimizer = torch.optim.AdamW(network.parameters())
        batches = iter(data.train_dataloader())
        batch = next(batches)

        def step() -> None:
            optimizer.zero_grad()
            learning.loss(batch).backward()
            optimizer.step()

        name = f"training step of {model}, batch {cfg.learning.batch_size}"
        both = side_by_side(name, step, "reading its batch", lambda: next(batches), RUNS, flop_per_s)
    return replace(both, details={"share_of_reading": both.peer_s / (both.ours_s + both.peer_s)})


TRAINING_COMPARISONS = (channels_last_training, config_cnn_step, palm_points_step)
