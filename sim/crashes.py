"""Crashing collections on purpose: whatever happens to them, the table must not change."""

import logging
import os
import shutil
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil

from preshape.data.tables import read_data_set
from preshape.data.trial_table import SCALARS, THETAS, TrialTable
from preshape.errors import InputError
from preshape.grasps.space import GraspSpace
from preshape.paths import project_root
from preshape.progress import Progress

TIMINGS = tuple(name for name in SCALARS if name.endswith("_s"))
"""The columns of wall-clock seconds, which differ between any two runs."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class CrashSettings:
    """What is done to collections.

    Args:
        kills: number of kills in all.
        seed: seed of the moments and of the damage.
        kills_per_table: kills until a collection may end and is compared.
        overrides: what is collected, as on the command line of `sim/collect.py`.
    """

    kills: int
    seed: int
    kills_per_table: int = 5
    overrides: tuple[str, ...] = ()


@dataclass
class CrashReport:
    """What came of it.

    Args:
        kills: collections killed with SIGKILL.
        kills_of_workers: their worker processes killed likewise, while the collections went on.
        damaged_files: files of finished scenes that were cut off or altered between two starts.
        tables: tables compared with the one of an undisturbed run.
        rows: rows of that.
        differing_rows: rows that differ, are missing or additional, in all tables.
        orphans: worker processes that outlived their collection by more than ten seconds. One that is still
            starting ends without having worked, but only when its imports are through.
    """

    kills: int = 0
    kills_of_workers: int = 0
    damaged_files: int = 0
    tables: int = 0
    rows: int = 0
    differing_rows: int = 0
    orphans: int = 0


def crash_collections(settings: CrashSettings, space: GraspSpace, folder: Path) -> CrashReport:
    """Collect once undisturbed, then again and again with crashes, and compare the tables.

    Every second table is collected by two processes at the same time.

    Args:
        settings: what is done.
        space: what theta means in the tables.
        folder: where it is done; what is there of an earlier test is deleted.

    Raises:
        InputError: if a collection refuses its settings.
    """
    rng = np.random.default_rng(settings.seed)
    start = time.monotonic()
    undisturbed = Collections(folder / "undisturbed", settings.overrides).finish(space)
    longest_s = time.monotonic() - start
    report = CrashReport(rows=len(undisturbed))
    with Progress("Crashing", settings.kills, "collections") as progress:
        while report.kills < settings.kills:
            collections = Collections(folder / "crashed", settings.overrides)
            enough = min(report.kills + settings.kills_per_table, settings.kills)
            at_once = 1 + report.tables % 2
            killed = at_once
            while report.kills < enough and killed:
                killed = collections.crash(sorted(rng.uniform(0, longest_s, at_once)), rng, report)
                progress.advance(killed)
            report.differing_rows += differing_rows(undisturbed, collections.finish(space))
            report.tables += 1
    return report


class Collections:
    """Starts of the same collection, in a folder of their own.

    Args:
        folder: the folder; emptied.
        overrides: what is collected.
    """

    def __init__(self, folder: Path, overrides: tuple[str, ...]) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self._folder = folder
        places = (f"paths.cache={folder / 'cache'}", f"paths.outputs={folder / 'outputs'}")
        script = str(project_root() / "sim" / "collect.py")
        self._command = (sys.executable, script, *places, f"collect.output={folder / 'table'}", *overrides)

    def finish(self, space: GraspSpace) -> TrialTable:
        """Collect to the end."""
        process = self._start()
        process.wait()
        self._check(process)
        return read_data_set(self._folder / "table", space)[1]

    def crash(self, moments_s: list[float], rng: np.random.Generator, report: CrashReport) -> int:
        """Start a collection for each moment and kill it then (s); afterwards, perhaps damage a file.

        Returns:
            How many were killed before they ended by themselves.
        """
        start, killed = time.monotonic(), 0
        processes = [self._start() for _ in moments_s]
        for process, moment_s in zip(processes, moments_s, strict=True):
            if rng.random() < 0.3:
                time.sleep(max(start + moment_s / 2 - time.monotonic(), 0.0))
                report.kills_of_workers += _kill_a_worker(process.pid)
            time.sleep(max(start + moment_s - time.monotonic(), 0.0))
            workers = _workers(process.pid)
            process.kill()
            if process.wait() < 0:
                killed += 1
            else:
                self._check(process)
            report.orphans += len(psutil.wait_procs(workers, timeout=10)[1])
        report.kills += killed
        if rng.random() < 0.5:
            report.damaged_files += self._damage(rng)
        return killed

    def _start(self) -> "subprocess.Popen[bytes]":
        with (self._folder / "messages.txt").open("ab") as messages:
            return subprocess.Popen(self._command, stdout=messages, stderr=messages)

    def _check(self, process: "subprocess.Popen[bytes]") -> None:
        if process.returncode != 0:
            raise InputError(
                f"The collection ended with status {process.returncode}",
                where=self._folder / "messages.txt",
                fix="look at the end of that file",
            )

    def _damage(self, rng: np.random.Generator) -> int:
        files = sorted((self._folder / "cache" / "collect").glob("*/*.jsonl"))
        files = [path for path in files if path.stat().st_size]
        if not files:
            return 0
        path = files[rng.integers(len(files))]
        content = bytearray(path.read_bytes())
        place = int(rng.integers(len(content)))
        if rng.random() < 0.5:
            os.truncate(path, place)
        else:
            content[place] ^= 1
            path.write_bytes(content)
        return 1


def differing_rows(one: TrialTable, other: TrialTable) -> int:
    """Number of trials that are not in both tables with the same values to the bit, timings aside."""
    contents = [{row["trial_id"]: repr(row) for row in _rows(table)} for table in (one, other)]
    return (
        sum(contents[0].get(number) != contents[1].get(number) for number in contents[0] | contents[1])
        + abs(len(one) - len(contents[0]))
        + abs(len(other) - len(contents[1]))
    )


def _rows(table: TrialTable) -> list[dict[str, object]]:
    rows = table.rows.drop(columns=list(TIMINGS)).to_dict("records")
    thetas = {name: getattr(table, name) for name in THETAS}
    return [row | {name: theta[i].tobytes() for name, theta in thetas.items()} for i, row in enumerate(rows)]


def _workers(pid: int) -> list[psutil.Process]:
    try:
        return psutil.Process(pid).children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def _kill_a_worker(pid: int) -> int:
    for process in _workers(pid):
        with suppress(psutil.NoSuchProcess):
            if "spawn_main" in " ".join(process.cmdline()):
                process.kill()
                return 1
    return 0
