"""Finishing the scenes of a run in worker processes, together with whoever else works in its folder."""

import logging
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import Protocol

from preshape.data.scene import Scene
from preshape.data.trial import Trial, TrialOutcome
from preshape.progress import Progress
from sim.effort import Effort
from sim.execution import Spectator
from sim.finished_scenes import FinishedScene
from sim.scene_claims import SceneClaims
from sim.trial import PlannedGrasp
from sim.workers import BeginStep, Work, Workers

LOOK_EVERY_S = 2.0
"""Time between two looks at what other processes have finished (s)."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class WorkerSettings:
    """Who does the work.

    Args:
        count: number of worker processes; None takes every core.
        scene_limit_s: a worker that needs more processor time for a scene is taken for stuck (s).
    """

    count: int | None = None
    scene_limit_s: float = 300.0


class TrialRunning(Protocol):
    """Tries grasps, as `sim.trial.TrialRunner` does."""

    def run(self, scene: Scene, grasp: PlannedGrasp, spectator: Spectator | None = None) -> Trial:
        """Try one grasp."""


@dataclass(frozen=True)
class GuardedRunner:
    """Tries grasps, but not those that two workers failed at: these trials are UNSTABLE.

    Args:
        runner: who really tries them.
        begin: says which trial comes next; False if it is to be left out.
    """

    runner: TrialRunning
    begin: BeginStep

    def run(self, scene: Scene, grasp: PlannedGrasp, spectator: Spectator | None = None) -> Trial:
        """Try one grasp."""
        if self.begin(grasp.trial_id):
            return self.runner.run(scene, grasp, spectator)
        return grasp.untried(scene, TrialOutcome.UNSTABLE)


def finish_scenes(
    what: str,
    build: Callable[[], Work[int, FinishedScene]],
    claims: SceneClaims,
    settings: WorkerSettings,
) -> Effort:
    """Work on scenes until those that are needed are finished, or no more may be tried.

    Args:
        what: what is being done, for the reader.
        build: makes the function that finishes the scene of a number; called once in each worker.
        claims: the scenes.
        settings: who does the work.

    Returns:
        What it took.

    Raises:
        InputError: if a scene cannot be kept, or workers do not start.
    """
    start, there = time.monotonic(), claims.counted
    with (
        closing(claims),
        Progress(what, claims.goal.wanted, claims.goal.unit, done=claims.counted) as progress,
        Workers(build, settings.count, settings.scene_limit_s) as workers,
    ):
        if not claims.complete:
            log.info(
                "%s: %d of %d %s are there; starting %d workers, which takes them a while",
                *(what, claims.counted, claims.goal.wanted, claims.goal.unit, workers.count),
            )
        looked = time.monotonic()
        while not (claims.complete or claims.exhausted):
            before = claims.counted
            while workers.free and (scene_id := claims.next()) is not None:
                workers.give(scene_id)
            for scene_id, finished in workers.wait(LOOK_EVERY_S):
                claims.add(finished or FinishedScene(scene_id, None, ()))
            if time.monotonic() - looked > LOOK_EVERY_S:
                claims.look()
                looked = time.monotonic()
            progress.advance(claims.counted - before, claims.goal.note)
        return Effort(claims.counted - there, time.monotonic() - start, workers.count)
