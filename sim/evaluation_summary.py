"""What came of an evaluation, per planner."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from preshape.data.trial_table import TrialTable
from preshape.evaluation.intervals import wilson
from preshape.files import write_json
from preshape.provenance import provenance


@dataclass(frozen=True)
class PlannerSummary:
    """How one planner did.

    Args:
        planner: its name.
        executed, lifted: numbers of trials.
        rate, low, high: lifted of executed with its 95 % Wilson interval; NaN if nothing was executed.
        predicted: mean success probability that the network gave the executed grasps.
    """

    planner: str
    executed: int
    lifted: int
    rate: float
    low: float
    high: float
    predicted: float

    def __str__(self) -> str:
        return f"{self.planner} {self.lifted} of {self.executed}"


def summarise(trials: TrialTable) -> list[PlannerSummary]:
    """Summaries of the planners in a table, in the order of their first trials."""
    executed = trials.executed
    summaries = []
    for planner in dict.fromkeys(trials.rows["planner"]):
        own = executed.where((executed.rows["planner"] == planner).to_numpy(dtype=bool))
        n, lifted = len(own), int(own.lifted.sum())
        rate = lifted / n if n else np.nan
        predicted = float(own.rows["success_prob"].mean()) if n else np.nan
        summaries.append(PlannerSummary(planner, n, lifted, rate, *wilson(lifted, n), predicted))
    return summaries


def write_summary(path: Path, summary: list[PlannerSummary], seed: int) -> None:
    """Write the summaries with where they come from, atomically."""
    planners = {
        planner.planner: {name: value for name, value in asdict(planner).items() if name != "planner"}
        for planner in summary
    }
    write_json(path, {**provenance(seed), "planners": planners})
