"""Collecting labelled grasps: scenes in parallel, every scene safe on disk as soon as it is done."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from preshape.data.scene import Scene
from preshape.data.tables import SCENES_FILE, TRIALS_FILE, read_data_set, write_scenes, write_trials
from preshape.data.trial import Trial
from preshape.data.trial_table import SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.grasps.space import GraspSpace
from preshape.progress import Progress
from sim.heuristic_trials import try_heuristic_grasps
from sim.laboratory import Laboratory, LaboratoryFactory
from sim.workers import run_in_order


@dataclass(frozen=True)
class CollectionSettings:
    """What to collect.

    Args:
        trials: executed trials wanted; unreachable ones come on top and are recorded, too.
        seed: seed of the run; with the number of a trial it decides everything random in it.
        workers: number of processes; None takes every core.
        max_scenes_per_trial: gives up after this many scenes per executed trial wanted.
    """

    trials: int
    seed: int
    workers: int | None = None
    max_scenes_per_trial: float = 3.0


def collect(
    factory: LaboratoryFactory,
    origin: TableOrigin,
    space: GraspSpace,
    settings: CollectionSettings,
    parts: Path,
) -> tuple[SceneTable, TrialTable]:
    """Collect trials scene by scene, in the order of scene numbers, until enough were executed.

    Every finished scene is a folder under `parts`. A second start takes those as they are and goes on, so
    that a run that was killed ends with the table of one that was not, however many workers either had.

    Args:
        factory: builds the laboratory in each worker.
        origin, space: what the tables are about.
        settings: what to collect.
        parts: folder of finished scenes; must belong to this configuration and seed alone.

    Raises:
        InputError: if hardly any trial can be executed, or nothing can be written to `parts`.
    """
    scenes: list[Scene] = []
    trials: list[Trial] = []
    executed = lifted = 0
    build = partial(_scene_worker, factory, settings.seed, parts)
    limit = int(settings.trials * settings.max_scenes_per_trial) + 10
    with Progress("Collecting", settings.trials, "executed trials") as progress:
        for folder in run_in_order(build, iter(range(limit)), settings.workers):
            found_scenes, found = read_data_set(folder, space)
            scenes += found_scenes.scenes
            trials += found.to_trials()
            executed += len(found.executed)
            lifted += int(found.lifted.sum())
            progress.advance(len(found.executed), f"{lifted} lifted")
            if executed >= settings.trials:
                break
        else:
            raise InputError(
                f"Only {executed} of {settings.trials} trials could be executed in {limit} scenes",
                where=parts,
                fix="check that the objects are of a size and in a place that the robot can reach",
            )
    return SceneTable(origin, tuple(scenes)), TrialTable.from_trials(trials, space, origin)


def _scene_worker(factory: LaboratoryFactory, run_seed: int, parts: Path) -> Callable[[int], Path]:
    return partial(_finished_scene, factory(), run_seed, parts)


def _finished_scene(laboratory: Laboratory, run_seed: int, parts: Path, scene_id: int) -> Path:
    """Folder with the tables of one scene, worked on now unless it is there."""
    folder = parts / f"{scene_id:06d}"
    # The trials are written last: if they are there, the scene is complete.
    if not (folder / TRIALS_FILE).exists():
        scene = laboratory.scenes.make(run_seed, scene_id)
        scenes = () if scene is None else (scene,)
        trials = [] if scene is None else try_heuristic_grasps(laboratory, run_seed, scene)
        write_scenes(folder / SCENES_FILE, SceneTable(laboratory.origin, scenes))
        write_trials(
            folder / TRIALS_FILE, TrialTable.from_trials(trials, laboratory.space, laboratory.origin)
        )
    return folder
