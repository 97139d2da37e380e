"""Compare planners on new scenes: `python sim/evaluate.py weights=FILE.safetensors`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from sim.tracked_evaluation import tracked_evaluation

log = logging.getLogger(__name__)


@entry_point("evaluate")
def main(cfg: DictConfig) -> None:
    """Plan and execute on every scene, then write the evaluation folder and its summary."""
    hydra = HydraConfig.get()
    output = Path(hydra.runtime.output_dir)
    sweeps = Path(hydra.sweep.dir).absolute() if hydra.mode is RunMode.MULTIRUN else None
    summary = tracked_evaluation(cfg, output, sweeps)
    log.info("Lifted: %s. Folder: %s", ", ".join(str(planner) for planner in summary), output)


if __name__ == "__main__":
    main()
