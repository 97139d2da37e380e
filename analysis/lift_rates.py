"""How many grasps lifted, with intervals."""

from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool

from preshape.data.trial_table import TrialTable
from preshape.evaluation.intervals import wilson


@dataclass(frozen=True)
class LiftRate:
    """Lifted of executed trials with the 95 % Wilson interval; the rate is NaN if nothing was executed."""

    executed: int
    lifted: int
    rate: float
    low: float
    high: float

    def to_dict(self) -> dict[str, float]:
        """The numbers by name, for result files."""
        return asdict(self)


def lift_rate(trials: TrialTable) -> LiftRate:
    """Rate over a table; trials that were not executed do not count."""
    return rate_of(trials.executed.lifted)


def rate_of(labels: Bool[np.ndarray, "n"]) -> LiftRate:
    """Rate over the labels of executed trials."""
    executed, lifted = len(labels), int(labels.sum())
    return LiftRate(executed, lifted, lifted / executed if executed else np.nan, *wilson(lifted, executed))


def of_object(trials: TrialTable, object_id: str) -> TrialTable:
    """The trials on one object."""
    return trials.where((trials.rows["object_id"] == object_id).to_numpy(dtype=bool))
