"""The trials that are collected on one scene: its heuristic grasps, and grasps that stray from them."""

import logging
import time
from dataclasses import replace

from preshape.data.scene import Scene
from preshape.data.trial import Trial
from preshape.errors import InputError
from sim.laboratory import Laboratory, trial_seed
from sim.trial import PlannedGrasp

HEURISTIC, EXPLORATION = "heuristic", "exploration"
"""Names of the planners in the table."""

log = logging.getLogger(__name__)


def try_grasps(laboratory: Laboratory, run_seed: int, scene: Scene) -> list[Trial]:
    """Trials of the heuristic and the explored grasps of one scene; none if its object cannot be made out."""
    start = time.perf_counter()
    try:
        view = laboratory.view(scene)
    except InputError as error:
        log.warning("Scene %d (%s) is left out: %s", scene.scene_id, scene.object_id, error.what)
        return []
    seconds = time.perf_counter() - start
    grasps = [(HEURISTIC, grasp) for grasp in view.initial]
    grasps += [(EXPLORATION, grasp) for grasp in laboratory.explored(scene, view)]
    trials = []
    for k, (planner, grasp) in enumerate(grasps):
        planned = PlannedGrasp(
            trial_id=scene.scene_id * laboratory.grasps_per_scene + k,
            planner=planner,
            face=grasp.face,
            initial=grasp.theta,
            planned=grasp.theta,
            success_prob=float("nan"),
            seed=trial_seed(run_seed, scene.scene_id, k),
        )
        trial = laboratory.runner.run(scene, planned)
        trials.append(replace(trial, rendering_s=seconds / len(grasps)))
    return trials
