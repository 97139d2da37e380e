"""Scenes are finished although workers die: the grasps that end them are recorded as unstable."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from synthetic_finished_scenes import finished_scene

from preshape.data.scene import Scene
from preshape.data.trial import Trial, TrialOutcome
from sim.collection import ExecutedTrials
from sim.finished_scenes import FinishedScene
from sim.finishing import GuardedRunner, WorkerSettings, finish_scenes
from sim.scene_claims import SceneClaims
from sim.trial import PlannedGrasp
from sim.workers import BeginStep, Work

DEADLY_TRIAL, DEADLY_SCENE = 10, 2


class DeadlyRunner:
    """Tries grasps with a known end, and dies of one of them."""

    def __init__(self, trials: tuple[Trial, ...]) -> None:
        self._trials = {trial.trial_id: trial for trial in trials}

    def run(self, scene: Scene, grasp: PlannedGrasp, spectator: object = None) -> Trial:
        if grasp.trial_id == DEADLY_TRIAL:
            os.abort()
        return self._trials[grasp.trial_id]


def finish(scene_id: int, begin: BeginStep) -> FinishedScene:
    if scene_id == DEADLY_SCENE:
        os.abort()
    known = finished_scene(scene_id)
    assert known.scene is not None
    runner = GuardedRunner(DeadlyRunner(known.trials), begin)
    trials = [runner.run(known.scene, planned(trial)) for trial in known.trials]
    return replace(known, trials=tuple(trials))


def planned(trial: Trial) -> PlannedGrasp:
    names = ("trial_id", "planner", "face", "initial", "planned", "success_prob", "seed")
    return PlannedGrasp(**{name: getattr(trial, name) for name in names})


def build() -> Work[int, FinishedScene]:
    return finish


def test_what_ends_two_workers_is_recorded_and_the_run_goes_on(tmp_path: Path) -> None:
    claims = SceneClaims(tmp_path, 4, 20, ExecutedTrials(9))
    finish_scenes("Testing", build, claims, WorkerSettings(2))
    finished = list(claims.finished())
    assert [scene.scene_id for scene in finished] == [0, 1, 2, 3, 4, 5]
    assert finished[DEADLY_SCENE].scene is None
    trials = {trial.trial_id: trial for scene in finished for trial in scene.trials}
    unstable = trials.pop(DEADLY_TRIAL)
    expected = {t.trial_id: t for n in (0, 1, 3, 4, 5) for t in finished_scene(n).trials}
    assert unstable.outcome is TrialOutcome.UNSTABLE
    assert np.isnan(unstable.reached).all()
    np.testing.assert_array_equal(unstable.planned, expected.pop(DEADLY_TRIAL).planned)
    assert {number: trial.outcome for number, trial in trials.items()} == {
        number: trial.outcome for number, trial in expected.items()
    }
