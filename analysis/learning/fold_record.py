"""The record of finished folds: what was measured once, wherever that was, stays measured."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from analysis.learning.fold_files import FILES, decisive_identity, read_fold
from preshape.errors import InputError
from preshape.evaluation.fold_summary import FoldResult
from preshape.evaluation.measured_files import (
    CURVES_FILE,
    METRICS_FILE,
    PREDICTIONS_FILE,
    read_predictions,
)
from preshape.files import atomic_path, exclusive, read_json, write_json

COLUMNS = ("trial_id", "scene_id", "lifted", "success_prob", "theta_predicted")
"""Columns of predictions that are read, and so are kept."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class FoldRecord:
    """Finished folds as files that are small enough to be versioned: no weights, no pictures.

    Args:
        folder: has a folder for each group, with a folder `<split>_fold<fold>` for each fold.
    """

    folder: Path

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes out that would read or change the record; waits until it is free.

        Raises:
            InputError: if the folder cannot be written to.
        """
        with exclusive(self.folder / ".lock"):
            yield

    def groups(self) -> list[str]:
        """Names of the groups that have a recorded fold."""
        return sorted({path.parent.parent.name for path in self.folder.glob(f"*/*/{METRICS_FILE}")})

    def folds(self, group: str) -> list[FoldResult]:
        """The recorded folds of a group, by split and number.

        They agree in settings and data: if there are others, those like the one with the latest date count.

        Raises:
            InputError: if a file is missing, damaged, or not of its fold.
        """
        recorded = self._all_folds(group)
        if not recorded:
            return []
        latest = max(recorded, key=lambda fold: str(fold.content["date"]))
        return [fold for fold in recorded if fold.has(_decisive_identity(latest))]

    def take(self, group: str, measured: Sequence[FoldResult]) -> None:
        """Record folds of a group; recorded ones with other settings or data go, equal ones are replaced.

        Args:
            group: name of the group.
            measured: folds with the same settings and data, as `read_fold` reads them.

        Raises:
            InputError: if a recorded file is damaged, or a file cannot be read or written.
        """
        recorded = self._all_folds(group)
        superseded = [fold for fold in recorded if not fold.has(_decisive_identity(measured[0]))]
        if superseded:
            names = ", ".join(fold.folder.name for fold in superseded)
            log.warning("Recorded folds of %s with other settings or data are removed: %s", group, names)
        for fold in superseded:
            _remove(fold.folder)
        contents = {fold.folder.name: fold.content for fold in recorded if fold not in superseded}
        for fold in measured:
            if contents.get(fold.folder.name) != fold.content:
                _write(fold, self.folder / group / fold.folder.name)

    def _all_folds(self, group: str) -> list[FoldResult]:
        paths = sorted((self.folder / group).glob(f"*/{METRICS_FILE}"))
        folds = [_read_recorded(path.parent) for path in paths]
        return sorted(folds, key=lambda fold: (fold.split, fold.content["fold"]))


def _read_recorded(folder: Path) -> FoldResult:
    try:
        return read_fold(folder)
    except InputError as error:
        fix = "bring its folder back with git, or delete it and make the report where the fold was trained"
        raise InputError(error.what, where=error.where, fix=fix) from error


def _decisive_identity(fold: FoldResult) -> dict[str, str]:
    return decisive_identity(fold.content, fold.folder / METRICS_FILE)


def _remove(folder: Path) -> None:
    """Remove a fold, its figures first: what an interrupt leaves is not taken for a finished one."""
    try:
        for name in reversed(FILES):
            (folder / name).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(
            f"The recorded fold cannot be removed: {error.strerror or error}",
            where=folder,
            fix="check the permissions of the folder",
        ) from error
    with suppress(OSError):  # it is not there, or holds something else
        folder.rmdir()


def _write(fold: FoldResult, folder: Path) -> None:
    _remove(folder)
    table = read_predictions(fold.folder / PREDICTIONS_FILE)
    with atomic_path(folder / PREDICTIONS_FILE) as temporary:
        columns = [name for name in COLUMNS if name in table]
        # probabilities hardly repeat themselves: a dictionary of them would only take room
        table[columns].to_parquet(temporary, index=False, compression="zstd", use_dictionary=False)
    write_json(folder / CURVES_FILE, read_json(fold.folder / CURVES_FILE))
    write_json(folder / METRICS_FILE, fold.content)
