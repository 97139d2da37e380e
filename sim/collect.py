"""Collect labelled grasps: `python sim/collect.py objects=grocery collect.trials=330`."""

import logging
from functools import partial
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.data.tables import write_data_set
from preshape.entry_point import entry_point
from preshape.files import write_json
from preshape.provenance import provenance
from sim.collection import CollectionSettings, collect, one_at_a_time
from sim.fingerprint import fingerprint
from sim.finished_scenes import to_tables
from sim.finishing import Effort

log = logging.getLogger(__name__)


@entry_point("collect")
def main(cfg: DictConfig) -> None:
    """Collect until enough trials were executed, then write both tables."""
    want, cache, output = cfg.collect, cfg.paths.cache, Path(cfg.collect.output)
    settings = CollectionSettings(want.trials, want.seed, want.block, want.workers, want.scene_limit_s)
    decisive = (cfg.laboratory, instantiate(cfg.objects.set).fingerprint, want.seed, want.block)
    parts = Path(cache) / "collect" / fingerprint(*decisive, cache=cache)
    OmegaConf.resolve(cfg.laboratory)  # worker processes may lack our resolvers
    finished, effort = collect(partial(instantiate, cfg.laboratory), settings, parts)
    with one_at_a_time(parts / "table.lock", wait=cfg.shard is None) as my_turn:
        if not my_turn:
            log.info("Enough trials; another shard writes the table: %s", output)
            return
        origin, space = instantiate(cfg.laboratory.origin), instantiate(cfg.robot.grasp_space)
        scenes, trials = to_tables(finished, origin, space)
        write_data_set(output, scenes, trials)
    if effort.units:
        log.info("%.0f executed trials an hour with %d workers", effort.per_hour, effort.workers)
        folder = Path(HydraConfig.get().runtime.output_dir)
        write_json(folder / "collection.json", provenance(want.seed) | _figures(effort))
    n_lifted, n_executed = trials.lifted.sum(), len(trials.executed)
    log.info("Lifted %d of %d executed trials on %d scenes: %s", n_lifted, n_executed, len(scenes), output)


def _figures(effort: Effort) -> dict[str, float]:
    return {
        "executed": effort.units,
        "seconds": effort.seconds,
        "workers": effort.workers,
        "executed_per_hour": effort.per_hour,
    }


if __name__ == "__main__":
    main()
