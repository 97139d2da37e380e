"""The trials of one scene: each heuristic initial grasp is tried."""

import logging
import time
from dataclasses import replace

from preshape.data.scene import Scene
from preshape.data.trial import Trial
from preshape.errors import InputError
from sim.laboratory import Laboratory, trial_seed
from sim.trial import PlannedGrasp

GRASPS_PER_SCENE = 3
"""The top face and two side faces."""

log = logging.getLogger(__name__)


def try_heuristic_grasps(laboratory: Laboratory, run_seed: int, scene: Scene) -> list[Trial]:
    """Trials of the heuristic initial grasps of one scene; none if its object cannot be made out."""
    start = time.perf_counter()
    try:
        view = laboratory.view(scene)
    except InputError as error:
        log.warning("Scene %d (%s) is left out: %s", scene.scene_id, scene.object_id, error.what)
        return []
    seconds = time.perf_counter() - start
    trials = []
    for k, grasp in enumerate(view.initial):
        planned = PlannedGrasp(
            trial_id=scene.scene_id * GRASPS_PER_SCENE + k,
            planner="heuristic",
            face=grasp.face,
            initial=grasp.theta,
            planned=grasp.theta,
            success_prob=float("nan"),
            seed=trial_seed(run_seed, scene.scene_id, k),
        )
        trial = laboratory.runner.run(scene, planned)
        trials.append(replace(trial, rendering_s=seconds / len(view.initial)))
    return trials
