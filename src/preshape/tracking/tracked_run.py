"""Keeping runs where they can be compared: MLflow, or nowhere."""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from preshape.tracking.logged_model import TrainedModel

MULTIRUN_TAG = "multirun"
"""Tag of the runs that one command made."""


@dataclass(frozen=True)
class SweepMember:
    """What part a run has in which sweep.

    Args:
        name: what people call it.
        digest: what tells the sweep from every other; one that is started again has the same.
        member_digest: what decides the figures of the run.
        trained: whether these figures are known already.
    """

    name: str
    digest: str
    member_digest: str
    trained: bool


@runtime_checkable
class TrackedRun(Protocol):
    """One run, while it goes on.

    Attributes:
        parent: the run of its sweep; None outside of one.
        was_finished: whether it is a run of a sweep that had already come to its end.
    """

    @property
    def parent(self) -> "TrackedRun | None":
        """The run of its sweep; None outside of one."""

    @property
    def was_finished(self) -> bool:
        """Whether it had already come to its end, in an earlier go of its sweep."""

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Add a point to each of these curves."""

    def keep(self, file: Path) -> None:
        """Keep a copy of a file with the run."""

    def keep_table(self, rows: Path, table: Path) -> None:
        """Keep the table of the whole sweep command with all its runs that have runs below them.

        Args:
            rows: the runs as CSV.
            table: the table as Markdown.
        """

    def keep_model(self, model: TrainedModel) -> None:
        """Keep a network so that others can use it without knowing how it was trained."""


@runtime_checkable
class Tracking(Protocol):
    """Where runs are kept."""

    def run(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str], sweep: SweepMember | None = None
    ) -> AbstractContextManager[TrackedRun]:
        """Begin a run with its resolved configuration; leaving the context ends it.

        In a sweep it is a child of the sweep's run. There is one of each name: that which was begun before
        goes on, or is replaced if it has other figures.
        """


class UntrackedRun:
    """A run that nobody keeps."""

    parent: TrackedRun | None = None
    was_finished = False

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Forget them."""

    def keep(self, file: Path) -> None:
        """Leave the file where it is."""

    def keep_table(self, rows: Path, table: Path) -> None:
        """Leave it where it is."""

    def keep_model(self, model: TrainedModel) -> None:
        """Leave its files where they are."""


class NoTracking:
    """Keeps nothing (`tracking=none`)."""

    @contextmanager
    def run(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str], sweep: SweepMember | None = None
    ) -> Iterator[TrackedRun]:
        """A run that nobody keeps."""
        yield UntrackedRun()


def content_digest(content: Any) -> str:
    """Digest by which a member of a sweep, or all of the sweep, is known again."""
    return hashlib.sha256(repr(content).encode()).hexdigest()[:16]
