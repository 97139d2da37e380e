"""Show how random trials ended beside their labels: `python sim/last_frames.py trials=100`."""

import preshape.command_line.startup

import logging
from functools import partial

from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.entry_point import entry_point
from preshape.data.tables import data_hash, read_data_set
from preshape.files import write_json
from preshape.provenance import provenance
from sim.frame_sheets import photograph, write_sheets
from sim.label_flips import sample_trials

log = logging.getLogger(__name__)


@entry_point("last_frames")
def main(cfg: DictConfig) -> None:
    """Write a sheet of lifted and one of failed trials, and what whoever looked at them found."""
    scenes, table = read_data_set(cfg.table, instantiate(cfg.robot.grasp_space))
    numbers = sample_trials(table, cfg.trials, cfg.seed)
    OmegaConf.resolve(cfg.laboratory)  # worker processes may lack our resolvers
    factory = partial(instantiate, cfg.laboratory)
    endings = photograph(factory, scenes, table, numbers, instantiate(cfg.camera_of_frames), cfg.workers)
    differing = sum(not ending.as_recorded for ending in endings)
    paths = write_sheets(endings, cfg.output, instantiate(cfg.sheet), cfg.quality)
    if cfg.disagreements is not None:
        found = {"n": len(numbers), "disagreements": cfg.disagreements, "how": cfg.how}
        about = {"data": data_hash(cfg.table), "repeated_differently": differing, "trials": numbers}
        write_json(cfg.result, provenance(cfg.seed) | found | about)
    log.info("%d trials, %d ended otherwise than recorded: %s", len(numbers), differing, ", ".join(paths))


if __name__ == "__main__":
    main()
