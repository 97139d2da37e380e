"""Compare planners on new scenes: `python sim/evaluate.py weights=FILE.safetensors`."""

import logging
from functools import partial
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.entry_point import entry_point
from preshape.files import file_hash
from sim.evaluation import SUMMARY_FILE, evaluate
from sim.evaluation_summary import summarise, write_summary
from sim.fingerprint import fingerprint

log = logging.getLogger(__name__)


@entry_point("evaluate")
def main(cfg: DictConfig) -> None:
    """Plan and execute on every scene, then write the evaluation folder and its summary."""
    settings = instantiate(cfg.evaluate)
    origin, space = instantiate(cfg.laboratory.origin), instantiate(cfg.robot.grasp_space)
    decisive = {key: cfg.evaluate[key] for key in cfg.evaluate if key not in ("scenes", "workers")}
    cache = cfg.paths.cache
    name = fingerprint(cfg.evaluator, OmegaConf.create(decisive), file_hash(cfg.weights), cache=cache)
    parts = Path(cache) / "evaluate" / name
    output = Path(HydraConfig.get().runtime.output_dir)
    trials = evaluate(
        partial(instantiate, cfg.evaluator), origin, space, settings, parts=parts, output=output
    )
    summary = summarise(trials)
    write_summary(output / SUMMARY_FILE, summary, settings.seed)
    log.info("Lifted: %s. Folder: %s", ", ".join(str(planner) for planner in summary), output)


if __name__ == "__main__":
    main()
