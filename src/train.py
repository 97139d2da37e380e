"""Train a network that predicts grasp success: `python src/train.py model=config_cnn`."""

import logging
from pathlib import Path

import torch
from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.entry_point import entry_point
from preshape.provenance import git_revision
from preshape.training import train

log = logging.getLogger(__name__)


@entry_point("train")
def main(cfg: DictConfig) -> None:
    """Fit the network, measure it on held-out trials, and keep both."""
    torch.manual_seed(cfg.seed)
    model = instantiate(cfg.model)
    data = instantiate(cfg.dataset.data)
    data.setup()  # data that cannot be used leaves no run behind
    settings = instantiate(cfg.trainer.settings)
    folder = Path(HydraConfig.get().runtime.output_dir)
    config = OmegaConf.to_container(cfg, resolve=True)
    with instantiate(cfg.tracking).run(cfg.run_name, config, {"git_revision": git_revision()}) as run:
        result = train(model, data, settings, folder, run)
    log.info("%s: %s; weights: %s", cfg.run_name, result.metrics.summary(), result.weights)


if __name__ == "__main__":
    main()
