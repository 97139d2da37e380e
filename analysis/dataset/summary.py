"""The figures of a data set for its result file."""

from typing import Any

import pandas as pd

from analysis.dataset.rates import frame_rate, rates_by
from analysis.lift_rates import LiftRate
from preshape.data.trial import TrialOutcome

DROPPED, HIGH_M = TrialOutcome.DROPPED.value, 0.1
"""Objects that ended higher (m), yet too low to count as lifted, may still be in the hand."""
PARTS = ("planning", "physics", "scene", "rendering")
"""Parts of a trial's time; each has its column."""


def summary(grasps: pd.DataFrame) -> dict[str, Any]:
    """Counts, rates with intervals, and times (s) of the rows that `grasp_frame` makes."""
    objects = rates_by(grasps, "object_id")
    both, never, always = both_outcomes(objects)
    return {
        "objects": len(objects),
        "scenes": int(grasps["scene_id"].nunique()),
        "planned": len(grasps),
        **frame_rate(grasps).to_dict(),
        "outcomes": grasps["outcome"].value_counts().to_dict(),
        "dropped_but_high": int(((grasps["outcome"] == DROPPED) & (grasps["lift_height_m"] > HIGH_M)).sum()),
        "planners": _plain(rates_by(grasps, "planner")),
        "faces": _plain(rates_by(grasps, "face")),
        "planners_and_faces": _plain(rates_by(grasps, ["planner", "face"])),
        "families": _plain(rates_by(grasps, "family")),
        "families_and_grasp_types": _plain(rates_by(grasps, ["family", "grasp_type"])),
        "object_rates": _plain(objects),
        "objects_with_both_outcomes": len(both),
        "objects_never_lifted": never,
        "objects_always_lifted": always,
        "seconds": seconds(grasps),
    }


def both_outcomes(objects: dict[str, LiftRate]) -> tuple[list[str], list[str], list[str]]:
    """Objects that were lifted in some executed trials but not in all; in none; in all."""
    never = [name for name, rate in objects.items() if rate.lifted == 0]
    always = [name for name, rate in objects.items() if 0 < rate.lifted == rate.executed]
    return [name for name in objects if name not in (*never, *always)], never, always


def seconds(grasps: pd.DataFrame) -> dict[str, float]:
    """Wall-clock seconds of one core per executed trial, by part, with what the others cost on top.

    `physics_share` is the physics' part of all the time.
    """
    executed = max(1, int(grasps["executed"].sum()))
    parts = {part: float(grasps[f"{part}_s"].sum()) / executed for part in PARTS}
    total = sum(parts.values())
    share = parts["physics"] / total if total else float("nan")
    return {**parts, "total": total, "physics_share": share}


def _plain(rates: dict[str, LiftRate]) -> dict[str, dict[str, float]]:
    return {name: rate.to_dict() for name, rate in rates.items()}
