"""Repeat trials under other settings and count the labels that flip: `python sim/sensitivity.py`."""

import preshape.command_line.startup

import logging
from dataclasses import asdict
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.entry_point import entry_point
from preshape.data.tables import data_hash, read_data_set
from preshape.files import write_json
from preshape.provenance import provenance
from sim.label_flips import sample_trials
from sim.variant_runs import VariantRun, run_variants
from sim.variants import chosen, compose_variants

log = logging.getLogger(__name__)


@entry_point("sensitivity")
def main(cfg: DictConfig) -> None:
    """Repeat trials in every variant and write how many labels flipped."""
    scenes, table = read_data_set(cfg.table, instantiate(cfg.robot.grasp_space))
    changes = chosen(OmegaConf.to_container(cfg.variants, resolve=False), cfg.only)
    runs, digest, objects = [], data_hash(cfg.table), instantiate(cfg.objects.set).fingerprint
    for variant in compose_variants("sensitivity", HydraConfig.get().overrides.task, changes):
        numbers = sample_trials(table, cfg.trials_of.get(variant.name, cfg.trials), cfg.seed)
        runs.append(VariantRun.kept_in(Path(cfg.paths.cache), variant, numbers, (digest, objects)))
    flips = {name: asdict(result) for name, result in run_variants(runs, scenes, table, cfg.workers).items()}
    write_json(cfg.output, provenance(cfg.seed) | {"data": digest, "variants": flips})
    flipping = sum(result["flips"] > 0 for result in flips.values())
    log.info("%d of %d variants flip labels: %s", flipping, len(flips), cfg.output)


if __name__ == "__main__":
    main()
