"""Fit a prior over theta to the grasps that lifted: `python src/fit_prior.py`."""

import preshape.command_line.startup

import logging

import numpy as np
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point

log = logging.getLogger(__name__)


@entry_point("fit_prior")
def main(cfg: DictConfig) -> None:
    """Learn from the training part of the trials, so that held-out objects stay unseen."""
    data = instantiate(cfg.dataset.data)
    data.setup()
    data.render(with_patches=False)
    train, held_out = (part.lifted() for part in (data.train, data.validation))
    prior = instantiate(cfg.prior.fit).fitted(
        train[np.arange(len(train)).tolist()],
        held_out[np.arange(len(held_out)).tolist()] if len(held_out) else None,
        instantiate(cfg.robot.grasp_space),
    )
    prior.write(cfg.output)
    log.info("Prior, fitted to %d grasps: %s", len(train), cfg.output)


if __name__ == "__main__":
    main()
