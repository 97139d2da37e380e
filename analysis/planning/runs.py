"""What an evaluation says of each planner, and of pairs of them."""

from dataclasses import asdict
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from scipy.stats import bootstrap
from sklearn.metrics import brier_score_loss

from analysis.evaluation_folder import Evaluation
from analysis.lift_rates import lift_rate, of_object, rate_of
from preshape.data.trial_table import TrialTable
from preshape.evaluation.calibration import reliability_diagram
from preshape.evaluation.paired import mcnemar
from preshape.evaluation.recalibration import cross_fitted, isotonic_regression, temperature_scaling

CORRECTIONS = {"temperature": temperature_scaling, "isotonic": isotonic_regression}
RESAMPLED = 2000


def planner_run(evaluation: Evaluation, condition: str, planner: str) -> dict[str, Any]:
    """Everything about one planner in one condition, as it stands in the result file."""
    own = of_planner(evaluation.trials, planner)
    known = outcome_by_scene(own)
    results = [evaluation.plan(scene.scene_id, planner).result for scene in evaluation.scenes.scenes]
    scenes = len(evaluation.scenes)
    of_scenes = rate_of(
        np.array([known.get(s.scene_id, False) for s in evaluation.scenes.scenes], dtype=bool)
    )
    return {
        "condition": condition,
        "planner": planner,
        "n": scenes,
        **lift_rate(own).to_dict(),
        "predicted": _mean(own.executed.rows["success_prob"].to_numpy(dtype=float)),
        "seconds": float(np.mean([result.runtime_s for result in results])),
        "evaluations": float(np.mean([result.evaluations for result in results])),
        "scenes": {"answered": len(known), **_without_executed(of_scenes.to_dict())},
        "objects": {name: _of_one(of_object(own, name)) for name in sorted(set(own.object_ids))},
        "reliability": reliability(own.executed),
    }


def of_planner(trials: TrialTable, planner: str) -> TrialTable:
    """The trials of one planner."""
    return trials.where((trials.rows["planner"] == planner).to_numpy(dtype=bool))


def outcome_by_scene(own: TrialTable) -> dict[int, bool]:
    """Whether a planner lifted the object, for each scene on which one of its grasps could be executed.

    Where several were executed, as of the heuristic, the one with the lowest trial seed counts: a draw.
    """
    executed = own.executed
    order = np.argsort(executed.rows["seed"].to_numpy(), kind="stable")[::-1]
    scene_ids, lifted = executed.scene_ids, executed.lifted
    return {int(scene_ids[i]): bool(lifted[i]) for i in order}


def paired_tests(
    evaluation: Evaluation, condition: str, planner: str, *, all_scenes: bool
) -> list[dict[str, Any]]:
    """McNemar's test between a planner and each of the others.

    Args:
        evaluation: what both did.
        condition: its name.
        planner: the one that is compared.
        all_scenes: whether a scene without an executed grasp counts as a failure; else only scenes count on
            which both executed one.
    """
    outcomes = {name: outcome_by_scene(of_planner(evaluation.trials, name)) for name in evaluation.planners}
    own, rows = outcomes.pop(planner), []
    for name, other in outcomes.items():
        scenes = [
            scene.scene_id
            for scene in evaluation.scenes.scenes
            if all_scenes or (scene.scene_id in own and scene.scene_id in other)
        ]
        first, second = (
            np.array([known.get(scene_id, False) for scene_id in scenes], dtype=bool)
            for known in (own, other)
        )
        compared = asdict(mcnemar(first, second))
        rows.append({"condition": condition, "planner": planner, "against": name, **compared})
    return rows


def reliability(executed: TrialTable) -> dict[str, Any] | None:
    """How far predicted and executed success differ, before and after correction by the other half of scenes.

    None if the planner gave no probabilities.
    """
    prob = executed.rows["success_prob"].to_numpy(dtype=float)
    if not len(prob) or not np.isfinite(prob).all():
        return None
    labels = executed.lifted
    half = np.isin(executed.scene_ids, np.unique(executed.scene_ids)[::2])
    result = {"predicted_as_planned": _agreement(labels, prob)}
    for name, fit in CORRECTIONS.items():
        result[name] = _agreement(labels, cross_fitted(fit, labels, prob, half))
    result["diagram"] = reliability_diagram(labels, prob).to_dict()
    return result


def _agreement(labels: Bool[np.ndarray, "n"], prob: Float[np.ndarray, "n"]) -> dict[str, Any] | None:
    if not np.isfinite(prob).all():
        return None
    gap = prob - labels
    low = high = float(gap[0])
    if np.ptp(gap) > 0:
        rng = np.random.default_rng(0)
        interval = bootstrap((gap,), np.mean, n_resamples=RESAMPLED, method="percentile", rng=rng)
        low, high = (float(bound) for bound in interval.confidence_interval)
    return {
        "predicted": float(prob.mean()),
        "gap": {"value": float(gap.mean()), "low": low, "high": high},
        "ece": reliability_diagram(labels, prob).expected_error,
        "brier": float(brier_score_loss(labels, prob, pos_label=True)),
    }


def _of_one(own: TrialTable) -> dict[str, Any]:
    prob = own.executed.rows["success_prob"].to_numpy(dtype=float)
    return {**lift_rate(own).to_dict(), "predicted": _mean(prob)}


def _mean(values: Float[np.ndarray, "n"]) -> float:
    return float(values.mean()) if len(values) else float("nan")


def _without_executed(rate: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in rate.items() if name != "executed"}
