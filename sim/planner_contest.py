"""Planners that compete on one scene: all see the same view and start from the same initial grasps."""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from preshape.data.scene import Scene
from preshape.data.trial import Face, Trial
from preshape.errors import InputError
from preshape.models.checkpoints import load_weights
from preshape.models.success_model import SuccessModel
from preshape.perception.view_files import save_view
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.grasp_planner import GraspPlanner, GraspPlanning, PlannerParts
from preshape.planning.plan_files import write_plan
from sim.execution import Spectator
from sim.finishing import TrialRunning
from sim.laboratory import Laboratory, trial_seed
from sim.recorder import Recorder, RecorderSettings
from sim.trial import PlannedGrasp

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class EvaluationSettings:
    """How planners are compared.

    Args:
        scenes: number of scenes.
        seed: seed of the run; another one than of the trials that the network learned from.
        poses_per_object: scenes of each object; None for `scenes` in all.
        workers: number of processes; None takes every core.
        every_grasp_of: planners of which every grasp is executed, as the paper did with the heuristic ones;
            of the others the best that the arm can reach.
        filmed_scenes: number of scenes, from the first, whose trials are filmed.
        filmed_planners: planners whose first executed trial is filmed.
    """

    scenes: int
    seed: int
    poses_per_object: int | None = None
    workers: int | None = None
    every_grasp_of: tuple[str, ...] = ("heuristic",)
    filmed_scenes: int = 0
    filmed_planners: tuple[str, ...] = ("heuristic", "inference")

    def with_objects(self, objects: int) -> "EvaluationSettings":
        """The settings with as many scenes as that number of objects asks for."""
        if self.poses_per_object is None:
            return self
        return replace(self, scenes=self.poses_per_object * objects, poses_per_object=None)


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Who plans and where it is tried.

    Args:
        laboratory: scenes, views and trials.
        planners: who plans, by name.
        recorder: how trials are filmed.
    """

    laboratory: Laboratory
    planners: Mapping[str, GraspPlanner]
    recorder: RecorderSettings


@dataclass(frozen=True, eq=False)
class RememberingRunner:
    """Tries grasps on one scene, each once: the same grasp and seed would give the same trial again.

    Args:
        runner: who really tries them.
        known: the trials so far.
    """

    runner: TrialRunning
    known: dict[tuple[Face, int, bytes], Trial] = field(default_factory=dict)

    def run(self, scene: Scene, grasp: PlannedGrasp, spectator: Spectator | None = None) -> Trial:
        """Try one grasp, or say what came of the same one; one that is filmed is always tried."""
        key = (grasp.face, grasp.seed, grasp.planned.tobytes())
        if key not in self.known or spectator is not None:
            self.known[key] = self.runner.run(scene, grasp, spectator)
        own = ("trial_id", "planner", "initial", "success_prob")
        return replace(self.known[key], **{name: getattr(grasp, name) for name in own})


PLANNER_PARTS = ("method", "box", "constraint", "prior", "proposer")
"""What a planner's configuration says of `PlannerParts`."""


def build_evaluator(
    laboratory: Laboratory,
    planners: Mapping[str, Mapping[str, Any]],
    planning: GraspPlanning,
    model: SuccessModel,
    weights: str | Path,
    recorder: RecorderSettings,
) -> Evaluator:
    """The evaluator whose planners all climb one trained network.

    Args:
        laboratory: scenes, views and trials.
        planners: for each name the parts of a planner (`conf/planner`).
        planning: what planners of the robot have in common.
        model, weights: the network and its trained weights.
        recorder: how trials are filmed.

    Raises:
        InputError: if the weights cannot be used, or a planner is for other robots.
    """
    load_weights(weights, model)
    made = {
        name: planning.planner(
            PlannerParts(name, **{part: parts[part] for part in PLANNER_PARTS if part in parts}), model
        )
        for name, parts in planners.items()
    }
    return Evaluator(laboratory, made, recorder)


def try_planners(
    evaluator: Evaluator, settings: EvaluationSettings, scene: Scene, folder: Path
) -> list[Trial]:
    """Let every planner plan on a scene, and execute what it found.

    Args:
        evaluator: the planners.
        settings: what is executed and filmed.
        scene: the scene.
        folder: where views, plans and films go.

    Returns:
        The trials; none if the object cannot be made out.
    """
    start = time.perf_counter()
    try:
        view = evaluator.laboratory.view(scene)
    except InputError as error:
        log.warning("Scene %d (%s) is left out: %s", scene.scene_id, scene.object_id, error.what)
        return []
    seconds = time.perf_counter() - start
    save_view(folder / "views" / f"{scene.scene_id}", view.observation)
    runner = RememberingRunner(evaluator.laboratory.runner)
    trials: list[Trial] = []
    for number, (name, planner) in enumerate(evaluator.planners.items()):
        plan = planner.plan_from(view.observation, view.segmented, view.initial)
        write_plan(folder / "plans" / f"{scene.scene_id}_{name}.json", plan)
        trials += _execute(evaluator, runner, settings, scene, plan, number, folder)
    return [replace(trial, rendering_s=seconds / len(trials)) for trial in trials]


def _execute(
    evaluator: Evaluator,
    runner: TrialRunning,
    settings: EvaluationSettings,
    scene: Scene,
    plan: GraspPlan,
    number: int,
    folder: Path,
) -> list[Trial]:
    """Execute a plan's grasps in the order of its ranking: all of them, or until one could be executed."""
    film = scene.scene_id < settings.filmed_scenes and plan.planner in settings.filmed_planners
    first = (scene.scene_id * len(evaluator.planners) + number) * evaluator.laboratory.proposals.starts
    trials: list[Trial] = []
    for start in plan.result.ranking.tolist():
        grasp = PlannedGrasp(
            trial_id=first + start,
            planner=plan.planner,
            face=plan.faces[start],
            initial=plan.result.initial_theta[start],
            planned=plan.result.theta[start],
            success_prob=float(plan.result.success_prob[start]),
            seed=trial_seed(settings.seed, scene.scene_id, start),
            planning_s=plan.result.runtime_s / len(plan.faces),
        )
        recorder = Recorder(evaluator.recorder) if film else None
        trial = runner.run(scene, grasp, recorder)
        trials.append(trial)
        if trial.outcome.executed:
            if recorder is not None:
                recorder.save_animation(folder / "animations" / f"{trial.trial_id}.webp", trial.outcome)
                film = False
            if plan.planner not in settings.every_grasp_of:
                break
    return trials
