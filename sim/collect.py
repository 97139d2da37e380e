"""Collect labelled grasps: `python sim/collect.py objects=grocery collect.trials=330`."""

import preshape.command_line.startup

from functools import partial
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.entry_point import entry_point
from sim.collected_tables import write_tables
from sim.collection import CollectionSettings, collect
from sim.fingerprint import fingerprint


@entry_point("collect")
def main(cfg: DictConfig) -> None:
    """Collect until enough trials were executed, then write both tables."""
    want, cache = cfg.collect, cfg.paths.cache
    settings = CollectionSettings(want.trials, want.seed, want.block, want.workers, want.scene_limit_s)
    decisive = (cfg.laboratory, instantiate(cfg.objects.set).fingerprint, want.seed, want.block)
    parts = Path(cache) / "collect" / fingerprint(*decisive, cache=cache)
    OmegaConf.resolve(cfg.laboratory)  # worker processes may lack our resolvers
    finished, effort = collect(partial(instantiate, cfg.laboratory), settings, parts)
    effort.save(Path(HydraConfig.get().runtime.output_dir) / "collection.json", want.seed, "executed")
    origin, space = instantiate(cfg.laboratory.origin), instantiate(cfg.robot.grasp_space)
    alone = cfg.shard is None
    write_tables(finished, origin, space, Path(want.output), parts / "table.lock", wait=alone)


if __name__ == "__main__":
    main()
