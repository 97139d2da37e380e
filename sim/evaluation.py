"""Comparing planners: all plan on the same views of new scenes, and their grasps are executed."""

import logging
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from preshape.checkpoints import load_weights
from preshape.data.scene import Scene
from preshape.data.tables import write_data_set
from preshape.data.trial import Face, Trial
from preshape.data.trial_table import SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.grasps.space import GraspSpace
from preshape.models.success_model import SuccessModel
from preshape.perception.view_files import save_view
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.plan_files import write_plan
from preshape.planning.view_planner import ViewPlanner
from sim.finished_scenes import FinishedScene, to_tables
from sim.finishing import GuardedRunner, WorkerSettings, finish_scenes
from sim.laboratory import Laboratory, SceneView, trial_seed
from sim.recorder import Recorder, RecorderSettings
from sim.scene_claims import SceneClaims
from sim.trial import PlannedGrasp
from sim.workers import BeginStep, Work

log = logging.getLogger(__name__)

SUMMARY_FILE = "evaluation.json"
PICTURES = ("plans", "views", "animations")
"""Folders of an evaluation beside its tables."""
BLOCK = 8
"""Consecutive scenes that one process claims at a time."""


@dataclass(frozen=True)
class EvaluationSettings:
    """How planners are compared.

    Args:
        scenes: number of scenes.
        seed: seed of the run; another one than of the trials that the network learned from.
        workers: number of processes; None takes every core.
        every_grasp_of: planners of which every grasp is executed, as the paper did with the heuristic ones;
            of the others the best that the arm can reach.
        filmed_scenes: number of scenes, from the first, whose trials are filmed.
        filmed_planners: planners whose first executed trial is filmed.
    """

    scenes: int
    seed: int
    workers: int | None = None
    every_grasp_of: tuple[str, ...] = ("heuristic",)
    filmed_scenes: int = 0
    filmed_planners: tuple[str, ...] = ("heuristic", "inference")


@dataclass(frozen=True)
class UsableScenes:
    """Enough are so many scenes on which something could be tried.

    Args:
        wanted: how many.
    """

    wanted: int
    unit: str = "scenes"
    note: str = ""

    def count(self, finished: FinishedScene) -> int:
        """1 for a scene that can be used."""
        return int(bool(finished.trials))


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Who plans and where it is tried.

    Args:
        laboratory: scenes, views and trials.
        planners: planners by name.
        recorder: how trials are filmed.
    """

    laboratory: Laboratory
    planners: Mapping[str, ViewPlanner]
    recorder: RecorderSettings


def build_evaluator(
    laboratory: Laboratory,
    planners: Mapping[str, Mapping[str, Any]],
    model: SuccessModel,
    weights: str | Path,
    recorder: RecorderSettings,
) -> Evaluator:
    """The evaluator whose planners all climb one trained network.

    Args:
        laboratory: scenes, views and trials.
        planners: for each name the `method` and the `box` of a planner (`conf/planner`).
        model, weights: the network and its trained weights.
        recorder: how trials are filmed.

    Raises:
        InputError: if the weights cannot be used.
    """
    load_weights(weights, model)
    views = {
        name: ViewPlanner(name, parts["method"], parts["box"], laboratory.space, laboratory.heuristic, model)
        for name, parts in planners.items()
    }
    return Evaluator(laboratory, views, recorder)


def evaluate(
    factory: Callable[[], Evaluator],
    origin: TableOrigin,
    space: GraspSpace,
    settings: EvaluationSettings,
    *,
    parts: Path,
    output: Path,
) -> TrialTable:
    """Evaluate scene by scene and write the evaluation folder.

    Finished scenes are kept under `parts`, so that a second start goes on where a first one was stopped.
    Scenes whose object does not come to rest or cannot be made out are replaced by the next number.

    Args:
        factory: builds the evaluator in each worker.
        origin, space: what the tables are about.
        settings: how planners are compared.
        parts: folder of finished scenes; must belong to this configuration, seed and network alone.
        output: the evaluation folder; replaced.

    Raises:
        InputError: if most scenes fail, or nothing can be written.
    """
    claims = SceneClaims(parts, BLOCK, 2 * settings.scenes + 5, UsableScenes(settings.scenes))
    build = partial(_scene_worker, factory, settings, parts)
    finish_scenes("Evaluating", build, claims, WorkerSettings(settings.workers))
    if claims.exhausted:
        raise InputError(
            f"Only {claims.counted} of {settings.scenes} scenes could be used",
            where=parts,
            fix="look at the warnings above; check the objects and the camera",
        )
    used = [finished for finished in claims.finished() if finished.trials]
    scenes, trials = to_tables(iter(used), origin, space)
    _assemble(output, [_folder(parts, finished.scene_id) for finished in used], scenes, trials)
    return trials


def _folder(parts: Path, scene_id: int) -> Path:
    """Where the pictures of a scene are kept until the evaluation is complete."""
    return parts / f"{scene_id:06d}"


def _scene_worker(
    factory: Callable[[], Evaluator], settings: EvaluationSettings, parts: Path
) -> Work[int, FinishedScene]:
    return partial(_finish_scene, factory(), settings, parts)


def _finish_scene(
    evaluator: Evaluator, settings: EvaluationSettings, parts: Path, scene_id: int, begin: BeginStep
) -> FinishedScene:
    laboratory = evaluator.laboratory
    scene = laboratory.scenes.make(settings.seed, scene_id)
    if scene is None:
        return FinishedScene(scene_id, None, ())
    guarded = replace(laboratory, runner=GuardedRunner(laboratory.runner, begin))
    trials = _try_planners(replace(evaluator, laboratory=guarded), settings, scene, _folder(parts, scene_id))
    return FinishedScene(scene_id, scene, tuple(trials))


def _try_planners(
    evaluator: Evaluator, settings: EvaluationSettings, scene: Scene, folder: Path
) -> list[Trial]:
    start = time.perf_counter()
    try:
        view = evaluator.laboratory.view(scene)
    except InputError as error:
        log.warning("Scene %d (%s) is left out: %s", scene.scene_id, scene.object_id, error.what)
        return []
    seconds = time.perf_counter() - start
    save_view(folder / "views" / f"{scene.scene_id}", view.observation)
    trials: list[Trial] = []
    for number, (name, planner) in enumerate(evaluator.planners.items()):
        plan = planner.plan_from(view.observation, view.segmented, view.initial)
        write_plan(folder / "plans" / f"{scene.scene_id}_{name}.json", plan)
        trials += _execute(evaluator, settings, scene, view, plan, number, folder)
    return [replace(trial, rendering_s=seconds / len(trials)) for trial in trials]


def _execute(
    evaluator: Evaluator,
    settings: EvaluationSettings,
    scene: Scene,
    view: SceneView,
    plan: GraspPlan,
    number: int,
    folder: Path,
) -> list[Trial]:
    """Execute a plan's grasps in the order of its ranking: all of them, or until one could be executed."""
    film = scene.scene_id < settings.filmed_scenes and plan.planner in settings.filmed_planners
    trials: list[Trial] = []
    for start in plan.result.ranking.tolist():
        grasp = PlannedGrasp(
            trial_id=(scene.scene_id * len(evaluator.planners) + number) * len(Face) + start,
            planner=plan.planner,
            face=plan.faces[start],
            initial=plan.result.initial_theta[start],
            planned=plan.result.theta[start],
            success_prob=float(plan.result.success_prob[start]),
            seed=trial_seed(settings.seed, scene.scene_id, start),
            planning_s=plan.result.runtime_s / len(view.initial),
        )
        recorder = Recorder(evaluator.recorder) if film else None
        trial = evaluator.laboratory.runner.run(scene, grasp, recorder)
        trials.append(trial)
        if trial.outcome.executed:
            if recorder is not None:
                recorder.save_animation(folder / "animations" / f"{trial.trial_id}.webp", trial.outcome)
                film = False
            if plan.planner not in settings.every_grasp_of:
                break
    return trials


def _assemble(output: Path, folders: list[Path], scenes: SceneTable, trials: TrialTable) -> None:
    # Its summary, written last by the command, says that a folder is complete.
    (output / SUMMARY_FILE).unlink(missing_ok=True)
    for name in PICTURES:
        shutil.rmtree(output / name, ignore_errors=True)
        for folder in folders:
            if (folder / name).is_dir():
                shutil.copytree(folder / name, output / name, dirs_exist_ok=True)
    write_data_set(output, scenes, trials)
