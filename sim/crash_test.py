"""Kill collections at random moments and compare what they end with: `python sim/crash_test.py kills=25`."""

import preshape.command_line.startup

import logging
from dataclasses import asdict
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from preshape.files import write_json
from preshape.provenance import provenance
from sim.crashes import CrashSettings, crash_collections

log = logging.getLogger(__name__)


@entry_point("crash_test")
def main(cfg: DictConfig) -> None:
    """Kill, damage and start again until there were enough kills, then write how many rows differ."""
    space = instantiate(cfg.robot.grasp_space)
    overrides = tuple(f"collect.{key}={value}" for key, value in cfg.collect.items())
    settings = CrashSettings(cfg.kills, cfg.seed, cfg.kills_per_table, overrides)
    report = crash_collections(settings, space, Path(HydraConfig.get().runtime.output_dir))
    write_json(cfg.output, provenance(cfg.seed) | asdict(report))
    log.info("%d differing rows after %d kills: %s", report.differing_rows, report.kills, cfg.output)


if __name__ == "__main__":
    main()
