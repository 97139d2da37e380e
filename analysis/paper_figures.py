"""The paper's numbers in the figures of its experiments: success rates and predicted probabilities."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

ALL = "all"
"""Stands for all objects together."""
COLUMNS = {"paper": "inference", "paper_constrained": "inference"}
"""Planners that stand in the paper under another name."""


@dataclass(frozen=True)
class PaperNumber:
    """What the paper prints of one planner, condition and object; None where it prints nothing.

    Args:
        rate: share of executed grasps that succeeded.
        predicted: mean success probability given by its network.
    """

    rate: float | None
    predicted: float | None


@cache
def _table() -> pd.DataFrame:
    frame = pd.read_csv(Path(__file__).with_name("paper_figures.csv"))
    return frame.set_index(["condition", "object"])


def paper_number(condition: str, planner: str, name: str) -> PaperNumber:
    """The paper's numbers.

    Args:
        condition: `seen`, `unseen`, `real_robot` or `two_finger`; of others the paper has nothing.
        planner: name of the planner.
        name: name of the object, or `ALL`.
    """

    def value(column: str) -> float | None:
        table = _table()
        known = column in table.columns and (condition, name) in table.index
        found = float(table.loc[(condition, name), column]) if known else np.nan
        return None if np.isnan(found) else found

    column = COLUMNS.get(planner, planner)
    percent = value(column)
    return PaperNumber(None if percent is None else percent / 100, value(f"{column}_predicted"))


def paper_objects(condition: str) -> list[str]:
    """Objects of one condition in the paper's order, `ALL` at the end."""
    return [str(name) for name in _table().loc[condition].index]
