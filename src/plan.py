"""Plan grasps for a saved RGB-D view: `python src/plan.py view=DIR weights=FILE.safetensors`."""

import preshape.command_line.startup

import logging
from pathlib import Path

import numpy as np
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from preshape.configured_planner import planner_of
from preshape.drawing.picture_files import save_picture
from preshape.drawing.plan_picture import plan_picture
from preshape.perception.view_choice import load_chosen_view
from preshape.planning.plan_files import write_plan

log = logging.getLogger(__name__)


@entry_point("plan")
def main(cfg: DictConfig) -> None:
    """Find the object, make initial grasps, plan, and write the grasps as JSON and as a picture."""
    planner = planner_of(cfg)
    observation = load_chosen_view(cfg.view, cfg.rgb_file, cfg.depth_file, cfg.camera_file)
    plan = planner.plan(observation, np.random.default_rng(cfg.seed))
    picture = plan_picture(observation, plan, instantiate(cfg.robot.hand))
    save_picture(Path(cfg.output) / "grasps.png", picture)
    write_plan(Path(cfg.output) / "grasps.json", plan)
    log.info("%s: %s", plan.summary(), Path(cfg.output) / "grasps.json")


if __name__ == "__main__":
    main()
