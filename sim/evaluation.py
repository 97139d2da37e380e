"""Comparing planners: all plan on the same views of new scenes, and their grasps are executed."""

import logging
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from preshape.data.tables import write_data_set
from preshape.data.trial_table import SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.files import copy_files
from preshape.grasps.space import GraspSpace
from sim.finished_scenes import FinishedScene, to_tables
from sim.finishing import GuardedRunner, WorkerSettings, finish_scenes
from sim.planner_contest import EvaluationSettings, Evaluator, try_planners
from sim.scene_claims import SceneClaims
from sim.workers import BeginStep, Work

log = logging.getLogger(__name__)

SUMMARY_FILE = "evaluation.json"
PICTURES = ("plans", "views", "animations")
"""Folders of an evaluation beside its tables."""
BLOCK = 8
"""Consecutive scenes that one process claims at a time."""


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
    trials = try_planners(replace(evaluator, laboratory=guarded), settings, scene, _folder(parts, scene_id))
    return FinishedScene(scene_id, scene, tuple(trials))


def _assemble(output: Path, folders: list[Path], scenes: SceneTable, trials: TrialTable) -> None:
    # Its summary, written last by the command, says that a folder is complete.
    (output / SUMMARY_FILE).unlink(missing_ok=True)
    for name in PICTURES:
        shutil.rmtree(output / name, ignore_errors=True)
        for folder in folders:
            copy_files(folder / name, output / name)
    write_data_set(output, scenes, trials)
