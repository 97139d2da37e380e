"""How often detections are right, and how often they should be by what the network says of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from preshape.cornell.detection import Detection
from preshape.evaluation.intervals import wilson
from preshape.evaluation.recalibration import cross_fitted, isotonic_regression, temperature_scaling

CORRECTIONS = {"temperature": temperature_scaling, "isotonic": isotonic_regression}


def detection_rates(folds: Sequence[Sequence[Detection]]) -> list[dict[str, Any]]:
    """Rows of the result file: each method with each number of starts, over all folds together.

    A planner climbs to where its network errs upwards, so that what it says of its own optima is corrected by
    such optima: those of the other folds, whose images are none of this fold's.

    Args:
        folds: what was detected in the test images of each fold.
    """
    found: dict[tuple[str, int], list[tuple[int, Detection]]] = {}
    for fold, detections in enumerate(folds):
        for own in detections:
            starts = 0 if own.method == "grid" else own.starts
            found.setdefault((own.method, starts), []).append((fold, own))
    rows = []
    for (method, starts), numbered in sorted(found.items()):
        correct = np.array([own.correct for _, own in numbered], dtype=bool)
        said = np.array([own.success_prob for _, own in numbered])
        n, right = len(correct), int(correct.sum())
        low, high = wilson(right, n)
        corrected = {
            name: _agreement(
                correct, cross_fitted(fit, correct, said, np.array([fold for fold, _ in numbered]))
            )
            for name, fit in CORRECTIONS.items()
        }
        rows.append(
            {
                "metric": f"detection_{method}" + (f"_{starts}" if starts else ""),
                "value": right / n,
                "low": low,
                "high": high,
                "n": n,
                **_agreement(correct, said),
                "corrected": corrected,
            }
        )
    return rows


def _agreement(correct: Bool[np.ndarray, "n"], said: Float[np.ndarray, "n"]) -> dict[str, float | None]:
    """Mean probability and Brier score; None if there is no probability."""
    if not np.isfinite(said).all():
        return {"predicted": None, "brier": None}
    return {"predicted": float(said.mean()), "brier": float(np.mean((said - correct) ** 2))}
