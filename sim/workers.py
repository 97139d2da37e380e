"""Worker processes, one thread each, that keep what they need between jobs and are replaced if they fail."""

import ctypes
import logging
import multiprocessing
import os
import signal
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Any, Generic, TypeVar

import psutil

from preshape.errors import InputError, bad_input_behind

Job = TypeVar("Job", bound=Hashable)
Result = TypeVar("Result")
BeginStep = Callable[[Hashable], bool]
"""Called by a job before each of its steps; False if the step is to be left out."""
Work = Callable[[Job, BeginStep], Result]
"""Does a job."""

# One process per core and one thread per process: more would only get in each other's way.
# The last one is for lavapipe, which draws the pictures.
ONE_THREAD = {
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
    # Pixels are drawn by the thread that asks for them; waiting for another one takes a tenth more time.
    "LP_NUM_THREADS": "0",
}
TRIES = 2
PATIENCE = 10
"""How much longer than its processor time a job may take on the clock, since others may keep the cores."""
PR_SET_PDEATHSIG = 1

log = logging.getLogger(__name__)


def available_cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(eq=False)
class _Worker:
    """A process and what it is at."""

    process: BaseProcess
    connection: Connection
    job: Any = None
    step: Hashable = None
    ready: bool = False
    begun_s: float = 0.0
    begun_processor_s: float = 0.0
    deadline: float = float("inf")

    def begin(self, limit_s: float) -> None:
        """Start the clocks of a job."""
        self.begun_s, self.begun_processor_s = time.monotonic(), self._processor_s()
        self.deadline = self.begun_s + limit_s

    def is_stuck(self, limit_s: float) -> bool:
        """Whether the job needs too long; if not, asks to be looked at again when it could."""
        elapsed_s = time.monotonic() - self.begun_s
        used_s = self._processor_s() - self.begun_processor_s
        if used_s >= limit_s or elapsed_s >= PATIENCE * limit_s:
            return True
        self.deadline = time.monotonic() + max(limit_s - used_s, 0.1)
        return False

    def _processor_s(self) -> float:
        with suppress(psutil.Error):  # a worker that just died is found out elsewhere
            times = psutil.Process(self.process.pid).cpu_times()
            return float(times.user + times.system)
        return self.begun_processor_s

    def kill(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


class Workers(Generic[Job, Result]):
    """Processes that do jobs, each started when there is a job for it.

    A worker that dies, or needs too long for a job, is replaced and its job begun again. If that happens a
    second time in the same step, the job is done without this step; if it happens a second time before the
    job's first step, the job is given up. What a job raises is raised here. Workers end with this process,
    however that ends.

    Args:
        build: makes the function that does a job; called once in each process. It and the jobs are pickled.
        count: number of processes; None takes every core.
        time_limit_s: most processor time that a job may take, without what `build` takes (s); on the clock
            ten times as long.
    """

    def __init__(
        self, build: Callable[[], Work[Job, Result]], count: int | None, time_limit_s: float
    ) -> None:
        self._build, self._limit_s = build, time_limit_s
        self.count = count or available_cores()
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []
        self._failures: Counter[tuple[Any, Hashable]] = Counter()
        self._left_out: defaultdict[Any, set[Hashable]] = defaultdict(set)
        self._failed_starts = 0

    def __enter__(self) -> "Workers[Job, Result]":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        for worker in (*self._idle, *self._busy):
            worker.kill()

    @property
    def busy(self) -> int:
        """Number of jobs that are being done."""
        return len(self._busy)

    @property
    def free(self) -> int:
        """Number of jobs that can be given."""
        return self.count - len(self._busy)

    def give(self, job: Job) -> None:
        """Let a free worker begin a job."""
        worker = self._idle.pop() if self._idle else self._start()
        if not worker.process.is_alive():
            worker.kill()
            worker = self._start()
        worker.job, worker.step = job, None
        if worker.ready:
            worker.begin(self._limit_s)
        self._busy.append(worker)
        try:
            worker.connection.send((job, frozenset(self._left_out[job])))
        except OSError:
            log.debug("Worker %d died just now; `wait` finds out.", worker.process.pid)

    def wait(self, timeout_s: float) -> list[tuple[Job, Result | None]]:
        """The jobs that were done in the meantime, with their results; None for a job that is given up.

        Args:
            timeout_s: how long to wait for the first.
        """
        if not self._busy:
            time.sleep(timeout_s)
        timeout_s = min([timeout_s, *(worker.deadline - time.monotonic() for worker in self._busy)])
        heard = wait([worker.connection for worker in self._busy], max(timeout_s, 0.0)) if self._busy else []
        done: list[tuple[Job, Result | None]] = []
        for worker in list(self._busy):
            if worker.connection in heard:
                done += self._receive(worker)
            elif time.monotonic() > worker.deadline and worker.is_stuck(self._limit_s):
                done += self._replace(worker, f"needed more than {self._limit_s:g} s of processor time")
        return done

    def _start(self) -> _Worker:
        os.environ.update(ONE_THREAD)
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs, self._build, os.getpid()), daemon=True)
        process.start()
        theirs.close()
        return _Worker(process, ours)

    def _receive(self, worker: _Worker) -> list[tuple[Job, Result | None]]:
        try:
            kind, content = worker.connection.recv()
        except (EOFError, OSError):
            worker.process.join()
            return self._replace(worker, f"died (exit code {worker.process.exitcode})")
        if kind == "error":
            raise content
        if kind == "done":
            self._busy.remove(worker)
            self._idle.append(worker)
            return [(worker.job, content)]
        if kind == "ready":
            worker.ready, self._failed_starts = True, 0
            worker.begin(self._limit_s)
        else:
            worker.step = content
        return []

    def _replace(self, worker: _Worker, why: str) -> list[tuple[Job, Result | None]]:
        self._busy.remove(worker)
        worker.kill()
        if not worker.ready:
            return self._start_again(worker, why)
        place = (worker.job, worker.step)
        self._failures[place] += 1
        given_up = self._failures[place] >= TRIES
        where = f"{worker.job}" if worker.step is None else f"{worker.job}, step {worker.step}"
        end = "it is left out." if given_up else "it is begun again."
        log.warning("The worker for job %s %s; %s", where, why, end)
        if given_up and (worker.step is None or worker.step in self._left_out[worker.job]):
            return [(worker.job, None)]
        if given_up:
            self._left_out[worker.job].add(worker.step)
        self.give(worker.job)
        return []

    def _start_again(self, worker: _Worker, why: str) -> list[tuple[Job, Result | None]]:
        self._failed_starts += 1
        if self._failed_starts > TRIES * self.count:
            raise InputError(
                f"Worker processes do not start: the last one {why}",
                where=f"{self.count} workers",
                fix="look at what they said above; if memory is short, take fewer workers",
            )
        self.give(worker.job)
        return []


def _serve(connection: Connection, build: Callable[[], Work[Any, Any]], parent: int) -> None:
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it died before it could be watched
        return
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        work = build()
        connection.send(("ready", None))
        while True:
            job, left_out = connection.recv()
            connection.send(("done", work(job, partial(_begin, connection, left_out))))
    except EOFError:
        return
    except Exception as error:
        connection.send(("error", _portable(error)))


def _begin(connection: Connection, left_out: frozenset[Hashable], step: Hashable) -> bool:
    connection.send(("step", step))
    return step not in left_out


def _portable(error: Exception) -> Exception:
    """An error that can be sent: what the user got wrong as it is, a defect as its traceback."""
    return bad_input_behind(error) or RuntimeError(f"In a worker process:\n{traceback.format_exc()}")
