"""Collect labelled grasps: `python sim/collect.py objects=grocery collect.trials=330`."""

import logging
from functools import partial
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.data.tables import SCENES_FILE, TRIALS_FILE, write_scenes, write_trials
from preshape.entry_point import entry_point
from sim.collection import CollectionSettings, collect
from sim.fingerprint import fingerprint

log = logging.getLogger(__name__)


@entry_point("collect")
def main(cfg: DictConfig) -> None:
    """Collect until enough trials were executed, then write both tables."""
    settings = CollectionSettings(cfg.collect.trials, cfg.collect.seed, cfg.collect.workers)
    parts = Path(cfg.paths.cache) / "collect" / fingerprint(cfg.laboratory, cfg.collect.seed)
    origin, space = instantiate(cfg.laboratory.origin), instantiate(cfg.robot.grasp_space)
    scenes, trials = collect(partial(instantiate, cfg.laboratory), origin, space, settings, parts)
    output = Path(cfg.collect.output)
    write_scenes(output / SCENES_FILE, scenes)
    write_trials(output / TRIALS_FILE, trials)
    log.info(
        "Lifted %d of %d executed trials (%d planned) on %d scenes: %s",
        trials.lifted.sum(),
        len(trials.executed),
        len(trials),
        len(scenes),
        output,
    )


if __name__ == "__main__":
    main()
