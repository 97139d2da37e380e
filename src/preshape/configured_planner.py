"""What `python src/plan.py` does, for Python programs."""

from pathlib import Path

import numpy as np
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from omegaconf import DictConfig

import preshape.command_line.entry_point  # noqa: F401 - registers what the configuration refers to
from preshape.command_line.composition import check_composition
from preshape.models.checkpoints import load_weights
from preshape.paths import project_root
from preshape.perception.view_choice import load_chosen_view
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.grasp_planner import GraspPlanner, GraspPlanning


def configured_planner(weights: str | Path | None, *choices: str) -> GraspPlanner:
    """The planner of `conf/plan.yaml`.

    Args:
        weights: a trained network (`model.safetensors` of a training); None for planners that need none.
        choices: as on the command line, such as `planner=cem` or `model=config_cnn`.

    Raises:
        InputError: if the choices do not fit together, or the weights cannot be used.
    """
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("plan", list(choices))
    cfg.weights = None if weights is None else str(weights)
    check_composition(cfg)
    return planner_of(cfg)


def planner_of(cfg: DictConfig) -> GraspPlanner:
    """The planner of a composed `conf/plan.yaml`.

    Raises:
        InputError: if the weights cannot be used, or the planner is for other robots.
    """
    model = None
    if cfg.weights is not None:
        model = instantiate(cfg.model)
        load_weights(cfg.weights, model)
    planning: GraspPlanning = instantiate(cfg.planning)
    return planning.planner(instantiate(cfg.planner_parts), model)


def plan_view(view: str | Path, weights: str | Path | None, *choices: str, seed: int = 0) -> GraspPlan:
    """Plan grasps for a saved view, ranked.

    Args:
        view: folder with `rgb.png`, `depth.png` and `camera.json`.
        weights, choices: see `configured_planner`.
        seed: of the initial grasps.

    Raises:
        InputError: if the view, the choices or the weights cannot be used.
    """
    planner = configured_planner(weights, *choices)
    return planner.plan(load_chosen_view(view), np.random.default_rng(seed))
