"""Planners compete on equal terms: the same view, initial grasps and seeds, whoever else takes part."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.trial import Trial
from preshape.errors import InputError
from preshape.models.checkpoints import save_weights
from preshape.paths import project_root
from sim.planner_contest import EvaluationSettings, Evaluator, try_planners

UNDECIDED = {"trial_id", "scene_s", "planning_s", "physics_s", "rendering_s"}
"""The number of a trial depends on who takes part, and seconds on the day."""
SETTINGS = EvaluationSettings(scenes=1, seed=1000)


@pytest.fixture(scope="module")
def evaluator(tmp_path_factory: pytest.TempPathFactory) -> Evaluator:
    place = tmp_path_factory.mktemp("place")
    weights = place / "model.safetensors"
    overrides = [f"paths.cache={place}", f"weights={weights}", "camera=kinect_ideal", "model=config_cnn"]
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("evaluate", [*overrides, "laboratory.scenes.only=[pringles_bbq]"])
    torch.manual_seed(0)
    save_weights(weights, instantiate(cfg.model), data_hash="none", git_revision="none", metrics={})
    return instantiate(cfg.evaluator)


def contest(evaluator: Evaluator, place: Path, *planners: str) -> list[Trial]:
    chosen = replace(evaluator, planners={name: evaluator.planners[name] for name in planners})
    scene = evaluator.laboratory.scenes.make(SETTINGS.seed, 0)
    assert scene is not None
    return try_planners(chosen, SETTINGS, scene, place)


def decided(trials: list[Trial], planner: str) -> list[dict[str, object]]:
    names = [field.name for field in fields(Trial) if field.name not in UNDECIDED]
    values = [{name: getattr(trial, name) for name in names} for trial in trials if trial.planner == planner]
    return [
        {name: v.tobytes() if isinstance(v, np.ndarray) else repr(v) for name, v in row.items()}
        for row in values
    ]


def test_planners_get_the_same_and_do_not_notice_each_other(evaluator: Evaluator, tmp_path: Path) -> None:
    trials = contest(evaluator, tmp_path / "all", "heuristic", "max_eval", "inference")
    assert {trial.object_id for trial in trials} == {"pringles_bbq"}
    starts = {trial.face: trial for trial in trials if trial.planner == "heuristic"}
    for trial in trials:
        same = starts[trial.face]
        np.testing.assert_array_equal(trial.initial, same.initial)
        assert trial.seed == same.seed
    for name in ("max_eval", "inference"):
        tried = [trial.outcome.executed for trial in trials if trial.planner == name]
        assert sum(tried[:-1]) == 0
    for trial in trials:
        if np.array_equal(trial.planned, starts[trial.face].planned):
            assert trial.outcome is starts[trial.face].outcome
    alone = contest(evaluator, tmp_path / "two", "heuristic", "inference")
    for name in ("heuristic", "inference"):
        assert decided(alone, name) == decided(trials, name)


def test_objects_that_the_set_lacks_are_refused(evaluator: Evaluator) -> None:
    with pytest.raises(InputError, match="teapot"):
        replace(evaluator.laboratory.scenes, only=("pringles_bbq", "teapot"))


def test_poses_are_counted_per_object() -> None:
    assert replace(SETTINGS, poses_per_object=20).with_objects(10).scenes == 200
    assert SETTINGS.with_objects(10) == SETTINGS
