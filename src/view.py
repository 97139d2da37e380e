"""Look at scenes, grasps, climbs and trials in the browser: `python src/view.py`."""

import preshape.command_line.startup

from functools import partial

import numpy as np
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from preshape.configured_planner import planner_of
from preshape.data.tables import read_data_set
from preshape.perception.view_choice import load_chosen_view
from preshape.viewer.request import Request
from preshape.viewer.saved_view_session import SavedViewSession
from preshape.viewer.serving import serve
from preshape.viewer.trial_session import FirstTrial, TrialParts, TrialSession


@entry_point("view")
def main(cfg: DictConfig) -> None:
    """Show a plan for a saved view, or the trials of a table, until interrupted."""
    files = (cfg.view, cfg.rgb_file, cfg.depth_file, cfg.camera_file)
    plans, is_saved = cfg.robot.heuristic is not None, any(name is not None for name in files)
    Request(cfg.robot.name, bool(cfg.robot.description), plans, is_saved or cfg.weights is not None).check()
    view = load_chosen_view(*files) if is_saved else None
    robot, planner = instantiate(cfg.robot.description), planner_of(cfg) if plans else None
    if view is not None and planner is not None:
        plan = planner.plan(view, np.random.default_rng(cfg.seed))
        build = partial(SavedViewSession, robot=robot, observation=view, plan=plan)
    else:
        tables = read_data_set(cfg.table, robot.grasp_space, instantiate(cfg.laboratory.origin))
        parts = TrialParts(robot, *tables, instantiate(cfg.stage), planner)
        build = partial(TrialSession, parts=parts, first=FirstTrial(cfg.object, cfg.outcome, cfg.trial))
    serve(instantiate(cfg.server), build)


if __name__ == "__main__":
    main()
