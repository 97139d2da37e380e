"""What the page shows of one scene."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

from analysis.evaluation_folder import Evaluation
from analysis.pages.climb_chart import ClimbChart, climb_chart
from analysis.pages.embedding import embedded_figure, embedded_file, embedded_picture
from analysis.wording import outcome_mark, plain_name, planner_name
from preshape.data.scene import Scene
from preshape.data.trial import Trial
from preshape.drawing.channel_grid import channel_grid
from preshape.drawing.grasp_overlay import grasp_overlay
from preshape.drawing.grasp_window import cut, grasp_window
from preshape.hands.kinematics import HandKinematics
from preshape.perception.object_view import object_cloud, object_patch
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.planning.grasp_plan import GraspPlan

SCALE = 2
"""How many times an overlay is larger than the view."""


@dataclass(frozen=True)
class TrialEntry:
    """One trial: who tried which grasp, what was predicted, what came of it; its film as data URI, if any.

    `moved` says whether the planner changed the initial grasp.
    """

    planner: str
    face: str
    moved: bool
    predicted: float
    outcome: str
    mark: str
    film: str | None


@dataclass(frozen=True)
class GraspEntry:
    """One start before and after planning: pictures as data URIs, probabilities, status, trials."""

    face: str
    before: str
    after: str
    prob_before: float
    prob_after: float
    status: str
    is_best: bool
    trials: tuple[TrialEntry, ...]


@dataclass(frozen=True)
class SceneSection:
    """One scene of the page; pictures are data URIs."""

    scene_id: int
    object_name: str
    view: str
    channels: str
    grasps: tuple[GraspEntry, ...]
    climb: ClimbChart
    trials: tuple[TrialEntry, ...]

    def tried(self, planner: str) -> list[TrialEntry]:
        """The trials of one planner."""
        return [trial for trial in self.trials if trial.planner == planner_name(planner)]


def scene_section(evaluation: Evaluation, scene: Scene, climber: str, hand: HandKinematics) -> SceneSection:
    """Collect the pictures and figures of one scene.

    Args:
        evaluation: where they come from.
        scene: the scene.
        climber: the planner whose climb is shown.
        hand: drawn at the grasps.

    Raises:
        InputError: if a view or plan is missing or damaged.
    """
    observation = evaluation.view(scene.scene_id)
    plan = evaluation.plan(scene.scene_id, climber)
    tried = evaluation.trials.where(evaluation.trials.scene_ids == scene.scene_id).to_trials()
    trials = tuple(_trial_entry(evaluation, trial) for trial in tried)
    return SceneSection(
        scene_id=scene.scene_id,
        object_name=plain_name(scene.object_id),
        view=embedded_picture(observation.rgb),
        channels=embedded_figure(channel_grid(_patch(observation))),
        grasps=tuple(
            _grasp_entry(observation, plan, start, hand, trials) for start in plan.result.ranking.tolist()
        ),
        climb=climb_chart(plan),
        trials=trials,
    )


def _trial_entry(evaluation: Evaluation, trial: Trial) -> TrialEntry:
    film = evaluation.animation(trial.trial_id)
    return TrialEntry(
        planner=planner_name(trial.planner),
        face=plain_name(trial.face.value),
        moved=not np.array_equal(trial.initial, trial.planned),
        predicted=trial.success_prob,
        outcome=trial.outcome.value,
        mark=outcome_mark(trial.outcome),
        film=None if film is None else embedded_file(film),
    )


def _grasp_entry(
    observation: Observation,
    plan: GraspPlan,
    start: int,
    hand: HandKinematics,
    trials: tuple[TrialEntry, ...],
) -> GraspEntry:
    result = plan.result
    face = plain_name(plan.faces[start].value)
    initial, planned = result.initial_theta[start], result.theta[start]
    return GraspEntry(
        face=face,
        before=embedded_picture(_drawn(observation, plan, hand, initial, None)),
        after=embedded_picture(_drawn(observation, plan, hand, initial, planned)),
        prob_before=result.initial_success_prob[start],
        prob_after=result.success_prob[start],
        status=plain_name(result.status[start].value),
        is_best=start == result.best,
        trials=tuple(trial for trial in trials if trial.face == face),
    )


def _drawn(
    observation: Observation,
    plan: GraspPlan,
    hand: HandKinematics,
    initial: np.ndarray,
    planned: np.ndarray | None,
) -> UInt8[np.ndarray, "h w 3"]:
    overlay = grasp_overlay(
        observation.rgb, observation.camera, hand, initial=initial, planned=planned, scale=SCALE
    )
    return cut(overlay, grasp_window(observation.camera, plan.result.initial_theta), SCALE)


def _patch(observation: Observation) -> np.ndarray:
    """The patch around the object that the network sees."""
    segmented = segment(observation, SegmentationSettings())
    return object_patch(observation, object_cloud(segmented).centre(observation.camera))
