"""How many labels flip when recorded trials are repeated under other settings."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from preshape.data.trial import Trial, TrialOutcome
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError
from preshape.evaluation.intervals import wilson


@dataclass(frozen=True)
class RepeatedTrial:
    """What came of a recorded trial when it was repeated.

    Args:
        trial_id: its number.
        recorded, repeated: outcomes then and now.
        soft_label: share of repetitions with a displaced object that were lifted; NaN if there were none.
        identical: whether outcome, lift height and reached grasp are the recorded ones to the bit.
    """

    trial_id: int
    recorded: TrialOutcome
    repeated: TrialOutcome
    soft_label: float
    identical: bool

    @property
    def was_lifted(self) -> bool:
        """The recorded label."""
        return self.recorded is TrialOutcome.LIFTED

    @property
    def is_lifted(self) -> bool:
        """The label of the repetition: what most repetitions ended with, if the object was displaced."""
        if np.isnan(self.soft_label):
            return self.repeated is TrialOutcome.LIFTED
        return self.soft_label > 0.5


@dataclass(frozen=True)
class LabelFlips:
    """How many labels flipped under one variant.

    Args:
        overrides: what was changed.
        n: number of repeated trials.
        flips: how many of them changed their label, lifted or not.
        share, low, high: flips of n with the 95 % Wilson interval.
        lifted_before, lifted_after: how many were lifted.
        not_executed: how many the robot could not try any more, or failed in the simulator.
        identical: how many came out as recorded to the bit.
        soft_labels: recorded label -> soft label -> number of trials; None without soft labels.
    """

    overrides: tuple[str, ...]
    n: int
    flips: int
    share: float
    low: float
    high: float
    lifted_before: int
    lifted_after: int
    not_executed: int
    identical: int
    soft_labels: dict[str, dict[str, int]] | None

    def __str__(self) -> str:
        return f"{self.flips} of {self.n}"


def sample_trials(table: TrialTable, n: int, seed: int) -> list[int]:
    """Numbers of random executed trials, half of them lifted as far as there are enough.

    A smaller sample of the same seed is part of a larger one, but for what one label lacks.

    Raises:
        InputError: if fewer than `n` trials of the table were executed.
    """
    executed = table.executed
    if len(executed) < n:
        raise InputError(
            f"The table has {len(executed)} executed trials, fewer than the {n} that are to be repeated",
            where="trials",
            fix="take fewer",
        )
    rng = np.random.default_rng(seed)
    numbers = executed.rows["trial_id"].to_numpy(dtype=np.int64)
    lifted, others = (rng.permutation(numbers[mask]) for mask in (executed.lifted, ~executed.lifted))
    n_lifted = min(len(lifted), max(n // 2, n - len(others)))
    return sorted(np.concatenate((lifted[:n_lifted], others[: n - n_lifted])).tolist())


def compared(recorded: Trial, repeated: Trial | None) -> RepeatedTrial:
    """A trial beside its repetition; None is a repetition that the simulator failed at."""
    if repeated is None:
        return RepeatedTrial(
            recorded.trial_id, recorded.outcome, TrialOutcome.UNSTABLE, float("nan"), identical=False
        )
    identical = (
        recorded.outcome is repeated.outcome
        and recorded.lift_height_m == repeated.lift_height_m
        and np.array_equal(recorded.reached, repeated.reached)
    )
    return RepeatedTrial(
        recorded.trial_id, recorded.outcome, repeated.outcome, repeated.soft_label, identical=identical
    )


def count_flips(overrides: Sequence[str], trials: Sequence[RepeatedTrial]) -> LabelFlips:
    """Summary of the repetitions under one variant."""
    n, flips = len(trials), sum(trial.was_lifted != trial.is_lifted for trial in trials)
    return LabelFlips(
        overrides=tuple(overrides),
        n=n,
        flips=flips,
        share=flips / n if n else float("nan"),
        **dict(zip(("low", "high"), wilson(flips, n), strict=True)),
        lifted_before=sum(trial.was_lifted for trial in trials),
        lifted_after=sum(trial.is_lifted for trial in trials),
        not_executed=sum(not trial.repeated.executed for trial in trials),
        identical=sum(trial.identical for trial in trials),
        soft_labels=_soft_labels(trials),
    )


def _soft_labels(trials: Sequence[RepeatedTrial]) -> dict[str, dict[str, int]] | None:
    known = [trial for trial in trials if not np.isnan(trial.soft_label)]
    if not known:
        return None
    values = sorted({trial.soft_label for trial in known})
    return {
        label: {
            f"{value:.2f}": sum(t.soft_label == value and t.was_lifted == lifted for t in known)
            for value in values
        }
        for label, lifted in (("lifted", True), ("not_lifted", False))
    }


def to_row(trial: RepeatedTrial) -> dict[str, object]:
    """A repeated trial as a JSON object; a soft label that there is not is null."""
    row = asdict(trial)
    return row | {"soft_label": None if np.isnan(trial.soft_label) else trial.soft_label}


def from_row(row: dict[str, object]) -> RepeatedTrial:
    """The repeated trial of `to_row`."""
    soft = row["soft_label"]
    return RepeatedTrial(
        trial_id=int(str(row["trial_id"])),
        recorded=TrialOutcome(str(row["recorded"])),
        repeated=TrialOutcome(str(row["repeated"])),
        soft_label=float("nan") if soft is None else float(str(soft)),
        identical=bool(row["identical"]),
    )
