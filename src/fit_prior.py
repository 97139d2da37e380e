"""Fit a prior over theta to the grasps that lifted: `python src/fit_prior.py`."""

import logging

import numpy as np
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.entry_point import entry_point
from preshape.planning.prior import GraspPrior

log = logging.getLogger(__name__)


@entry_point("fit_prior")
def main(cfg: DictConfig) -> None:
    """Learn from the training part of the trials, so that held-out objects stay unseen."""
    data = instantiate(cfg.dataset.data)
    data.setup()
    data.render(with_patches=False)
    lifted = data.train.lifted()
    examples = lifted[np.arange(len(lifted)).tolist()]
    prior = GraspPrior.fitted(
        examples.theta.double().numpy(),
        examples.view.T_camera_box.double().numpy(),
        instantiate(cfg.robot.grasp_space),
        components=cfg.components,
        seed=cfg.seed,
    )
    prior.write(cfg.output)
    log.info("Prior of %d distributions, fitted to %d grasps: %s", cfg.components, len(lifted), cfg.output)


if __name__ == "__main__":
    main()
