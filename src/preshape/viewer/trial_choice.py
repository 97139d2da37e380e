"""Which trials of a table are browsed."""

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from preshape.data.trial import TrialOutcome
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError

EXECUTED = "executed"
"""Stands for all outcomes of grasps that the hand really tried."""


@dataclass(frozen=True)
class FirstTrial:
    """Which trials are browsed first.

    Args:
        object_id: name of their object; None for all.
        outcome: value of an outcome, or `executed`; None for all.
        trial_id: number of the one that is shown first; None for the first of them.
    """

    object_id: str | None = None
    outcome: str | None = None
    trial_id: int | None = None


@dataclass(frozen=True, eq=False)
class TrialChoice:
    """The trials of a table that are of an object and ended in some way.

    Args:
        table: the trials.
    """

    table: TrialTable

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of the table's objects, sorted."""
        return tuple(sorted(set(self.table.object_ids)))

    @property
    def outcomes(self) -> tuple[str, ...]:
        """What can be chosen as outcome."""
        return (EXECUTED, *(outcome.value for outcome in TrialOutcome))

    def rows(self, object_id: str | None = None, outcome: str | None = None) -> Int64[np.ndarray, "m"]:
        """Rows of the trials, in the table's order.

        Args:
            object_id: name of the object; None for all.
            outcome: value of an outcome, or `executed`; None for all.

        Raises:
            InputError: if there is no such object or outcome.
        """
        rows = self.table.rows
        wanted = np.full(len(rows), True)
        if object_id is not None:
            _check("object", object_id, self.objects)
            wanted &= (rows["object_id"] == object_id).to_numpy()
        if outcome is not None:
            _check("outcome", outcome, self.outcomes)
            executed = [entry.value for entry in TrialOutcome if entry.executed]
            wanted &= rows["outcome"].isin(executed if outcome == EXECUTED else [outcome]).to_numpy()
        return np.nonzero(wanted)[0].astype(np.int64)

    def row_of(self, trial_id: int) -> int:
        """Row of the trial with a number.

        Raises:
            InputError: if there is none.
        """
        numbers = self.table.rows["trial_id"].to_numpy()
        (found,) = np.nonzero(numbers == trial_id)
        if len(found) == 0:
            limits = f"between {numbers.min()} and {numbers.max()}" if len(numbers) else "of another table"
            raise InputError(
                f"The table has no trial {trial_id}",
                where="trial",
                fix=f"choose a number {limits} from its column trial_id",
            )
        return int(found[0])

    def count_in_words(self, rows: Int64[np.ndarray, "m"]) -> str:
        """How many trials there are, and how many of the executed ones lifted."""
        chosen = self.table.rows["outcome"].iloc[rows]
        executed = sum(TrialOutcome(outcome).executed for outcome in chosen)
        lifted = int((chosen == TrialOutcome.LIFTED.value).sum())
        return f"{len(rows)} trials, {executed} executed, {lifted} lifted"


def _check(what: str, name: str, known: Iterable[str]) -> None:
    choices = list(known)
    if name in choices:
        return
    near = difflib.get_close_matches(name, choices, n=3, cutoff=0.4) or choices[:10]
    raise InputError(
        f"The table has no trial with {what} {name!r}",
        where=what,
        fix=f"choose, for instance, {', '.join(near)}",
    )
