"""Train a network that predicts grasp success: `python src/train.py`."""

import preshape.command_line.startup

import logging
from pathlib import Path

import torch
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.entry_point import entry_point
from preshape.training_job import TrainingJob

log = logging.getLogger(__name__)


@entry_point("train")
def main(cfg: DictConfig) -> None:
    """Fit the network, measure it on held-out trials, and keep both."""
    torch.manual_seed(cfg.seed)
    hydra = HydraConfig.get()
    experiment = hydra.runtime.choices.get("experiment") or "default"
    counts = {key: cfg.dataset.data.get(key) for key in ("trials", "trials_learned")}
    settings = {
        "about": {"experiment": experiment, "split": cfg.split, "fold": cfg.fold, **counts},
        "config": OmegaConf.to_container(cfg, resolve=True),
        "unresolved": OmegaConf.to_container(cfg, resolve=False),
        "in_sweep": hydra.mode is RunMode.MULTIRUN,
        "retrain_after_code_changes": cfg.retrain_after_code_changes,
    }
    job = TrainingJob(cfg.run_name, Path(hydra.runtime.output_dir), **settings)
    parts = (instantiate(cfg.model), instantiate(cfg.dataset.data), instantiate(cfg.trainer.settings))
    log.info("%s", job.run(*parts, instantiate(cfg.tracking)))


if __name__ == "__main__":
    main()
