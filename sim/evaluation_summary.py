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
        scenes, answered: scenes on which it planned, and those of them on which a grasp could be executed.
        executed, lifted: numbers of trials.
        rate, low, high: lifted of executed with its 95 % Wilson interval; NaN if nothing was executed.
        predicted: mean success probability that the network gave the executed grasps.
    """

    planner: str
    scenes: int
    answered: int
    executed: int
    lifted: int
    rate: float
    low: float
    high: float
    predicted: float

    def __str__(self) -> str:
        missed = self.scenes - self.answered
        beyond = f" ({missed} of {self.scenes} scenes without a grasp within reach)" if missed else ""
        return f"{self.planner} {self.lifted} of {self.executed}{beyond}"


def summarise(trials: TrialTable) -> list[PlannerSummary]:
    """Summaries of the planners in a table, in the order of their first trials."""
    summaries = []
    for planner in dict.fromkeys(trials.rows["planner"]):
        own = trials.where((trials.rows["planner"] == planner).to_numpy(dtype=bool))
        executed = own.executed
        n, lifted = len(executed), int(executed.lifted.sum())
        summaries.append(
            PlannerSummary(
                planner=planner,
                scenes=len(set(own.scene_ids.tolist())),
                answered=len(set(executed.scene_ids.tolist())),
                executed=n,
                lifted=lifted,
                rate=lifted / n if n else np.nan,
                low=wilson(lifted, n)[0],
                high=wilson(lifted, n)[1],
                predicted=float(executed.rows["success_prob"].mean()) if n else np.nan,
            )
        )
    return summaries


def write_summary(path: Path, summary: list[PlannerSummary], seed: int) -> None:
    """Write the summaries with where they come from, atomically."""
    planners = {
        planner.planner: {name: value for name, value in asdict(planner).items() if name != "planner"}
        for planner in summary
    }
    write_json(path, {**provenance(seed), "planners": planners})
