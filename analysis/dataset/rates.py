"""Lift rates of executed grasps, by group and over a number."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from jaxtyping import Float

from analysis.lift_rates import LiftRate, rate_of


@dataclass(frozen=True)
class RateBin:
    """The rate of the grasps within a range.

    Args:
        low, high: the range.
        mean: mean of the numbers in it.
        rate: its lifted and executed grasps.
    """

    low: float
    high: float
    mean: float
    rate: LiftRate


def rates_by(grasps: pd.DataFrame, columns: str | Sequence[str]) -> dict[str, LiftRate]:
    """Rate of each group of grasps that share the values of the columns; names are joined by `, `."""
    names = [columns] if isinstance(columns, str) else list(columns)
    groups = grasps.groupby(names, sort=True)
    return {", ".join(map(str, key)): frame_rate(group) for key, group in groups}


def frame_rate(grasps: pd.DataFrame) -> LiftRate:
    """Rate of all grasps; those that were not executed do not count."""
    return rate_of(grasps.loc[grasps["executed"], "lifted"].to_numpy(dtype=bool))


def binned_rates(grasps: pd.DataFrame, column: str, bins: int) -> list[RateBin]:
    """Rates over a column of numbers, in ranges that hold about equally many executed grasps.

    Grasps without a number are left out. There is one range if all numbers are the same, none without any.
    """
    executed = grasps[grasps["executed"] & grasps[column].notna()]
    values, labels = executed[column].to_numpy(dtype=float), executed["lifted"].to_numpy(dtype=bool)
    if not len(values):
        return []
    edges = np.unique(np.quantile(values, np.linspace(0, 1, bins + 1)))
    places = _places(values, edges)
    bins = []
    for k in range(max(1, len(edges) - 1)):
        own = places == k
        if own.any():  # few numbers may leave a range empty
            low, high = float(edges[k]), float(edges[min(k + 1, len(edges) - 1)])
            bins.append(RateBin(low, high, float(values[own].mean()), rate_of(labels[own])))
    return bins


def gridded_counts(
    grasps: pd.DataFrame, columns: tuple[str, str], edges: Float[np.ndarray, "e"]
) -> Float[np.ndarray, "2 c c"]:
    """Lifted and executed grasps in the cells of a square grid; the first column is the first axis."""
    executed = grasps[grasps["executed"]]
    x, y = (executed[column].to_numpy(dtype=float) for column in columns)
    lifted = np.histogram2d(x, y, bins=(edges, edges), weights=executed["lifted"].to_numpy(dtype=float))[0]
    return np.stack((lifted, np.histogram2d(x, y, bins=(edges, edges))[0]))


def _places(values: Float[np.ndarray, "n"], edges: Float[np.ndarray, "e"]) -> np.ndarray:
    """Number of each value's range; the last range includes its upper edge."""
    last = max(0, len(edges) - 2)
    return np.clip(np.searchsorted(edges, values, side="right") - 1, 0, last)
