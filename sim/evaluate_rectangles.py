"""Compare planners of rectangles on new scenes: `python sim/evaluate_rectangles.py weights=FILE`."""

import logging
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from preshape.entry_point import entry_point
from sim.configured_evaluation import run_evaluation

log = logging.getLogger(__name__)


@entry_point("evaluate_rectangles")
def main(cfg: DictConfig) -> None:
    """Plan and execute on every scene, then write the evaluation folder and its summary."""
    output = Path(HydraConfig.get().runtime.output_dir)
    summary = run_evaluation(cfg, output)
    log.info("Lifted: %s. Folder: %s", ", ".join(str(planner) for planner in summary), output)


if __name__ == "__main__":
    main()
