"""Learn from the planner's own grasps, round by round: `python sim/improve.py rounds=2`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from sim.improvement import improve

log = logging.getLogger(__name__)


@entry_point("improve")
def main(cfg: DictConfig) -> None:
    """Train, compare, acquire, and train again; every round's rates are in the result file."""
    output = Path(HydraConfig.get().runtime.output_dir)
    rounds = improve(cfg, output)
    log.info("%s. Result file: %s", "; ".join(map(str, rounds)), output / "improvement.json")


if __name__ == "__main__":
    main()
