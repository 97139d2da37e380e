"""Collecting labelled grasps: scenes in parallel, every scene safe on disk as soon as it is done."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from preshape.data.trial import TrialOutcome
from preshape.errors import InputError
from sim.effort import Effort
from sim.finished_scenes import FinishedScene
from sim.finishing import GuardedRunner, WorkerSettings, finish_scenes
from sim.laboratory import Laboratory, LaboratoryFactory
from sim.scene_claims import SceneClaims
from sim.scene_trials import try_grasps
from sim.workers import BeginStep, Work


@dataclass(frozen=True)
class CollectionSettings:
    """What to collect.

    Args:
        trials: executed trials wanted; unreachable ones come on top and are recorded, too.
        seed: seed of the run; with the number of a trial it decides everything random in it.
        block: number of consecutive scenes that a process claims at a time.
        workers: number of worker processes; None takes every core.
        scene_limit_s: a worker that needs more processor time for a scene is taken for stuck (s).
        max_scenes_per_trial: gives up after this many scenes per executed trial wanted.
    """

    trials: int
    seed: int
    block: int = 8
    workers: int | None = None
    scene_limit_s: float = 300.0
    max_scenes_per_trial: float = 3.0


@dataclass
class ExecutedTrials:
    """Enough are so many executed trials.

    Args:
        wanted: how many.
        lifted: how many of those counted were lifted.
    """

    wanted: int
    lifted: int = 0
    unit: str = "executed trials"

    @property
    def note(self) -> str:
        """How many were lifted."""
        return f"{self.lifted} lifted"

    def count(self, finished: FinishedScene) -> int:
        """The scene's executed trials."""
        self.lifted += sum(trial.outcome is TrialOutcome.LIFTED for trial in finished.trials)
        return sum(trial.outcome.executed for trial in finished.trials)


def collect(
    factory: LaboratoryFactory, settings: CollectionSettings, parts: Path
) -> tuple[Iterator[FinishedScene], Effort]:
    """Collect trials scene by scene until enough were executed in the scenes from the first on.

    Every finished scene is kept under `parts`. A second start goes on from there, and several processes, here
    or on other machines, share the work if they work in the same folder. Whoever does it, the scenes that
    come out are the same.

    Args:
        factory: builds the laboratory in each worker.
        settings: what to collect.
        parts: folder of finished scenes; must belong to this configuration, seed and block size alone.

    Returns:
        The finished scenes in the order of their numbers, and what it took to get them.

    Raises:
        InputError: if hardly any trial can be executed, or nothing can be written to `parts`.
    """
    limit = int(settings.trials * settings.max_scenes_per_trial) + 10
    claims = SceneClaims(parts, settings.block, limit, ExecutedTrials(settings.trials))
    workers = WorkerSettings(settings.workers, settings.scene_limit_s)
    effort = finish_scenes("Collecting", partial(_scene_worker, factory, settings.seed), claims, workers)
    if claims.exhausted:
        raise InputError(
            f"Only {claims.counted} of {settings.trials} trials could be executed in {limit} scenes",
            where=parts,
            fix="check that the objects are of a size and in a place that the robot can reach",
        )
    return claims.finished(), effort


def _scene_worker(factory: LaboratoryFactory, run_seed: int) -> Work[int, FinishedScene]:
    return partial(_finish_scene, factory(), run_seed)


def _finish_scene(laboratory: Laboratory, run_seed: int, scene_id: int, begin: BeginStep) -> FinishedScene:
    scene = laboratory.scenes.make(run_seed, scene_id)
    if scene is None:
        return FinishedScene(scene_id, None, ())
    guarded = replace(laboratory, runner=GuardedRunner(laboratory.runner, begin))
    return FinishedScene(scene_id, scene, tuple(try_grasps(guarded, run_seed, scene)))
