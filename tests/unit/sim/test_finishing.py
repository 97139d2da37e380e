"""Scenes are finished although workers die: the grasps that end them are recorded as unstable."""

from pathlib import Path

import numpy as np
from deadly_scenes import DEADLY_SCENE, DEADLY_TRIAL, build
from synthetic_finished_scenes import finished_scene

from preshape.data.trial import TrialOutcome
from sim.collection import ExecutedTrials
from sim.finishing import WorkerSettings, finish_scenes
from sim.scene_claims import SceneClaims


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
