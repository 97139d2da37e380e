"""A list of jobs, done by worker processes, with a line of progress."""

from collections.abc import Callable, Iterator, Sequence

from preshape.progress import Progress
from sim.workers import Job, Result, Work, Workers

LOOK_EVERY_S = 2.0
"""Longest time until the line of progress is brought up to date (s)."""


def do_jobs(
    what: str,
    build: Callable[[], Work[Job, Result]],
    jobs: Sequence[Job],
    *,
    unit: str,
    workers: int | None = None,
    time_limit_s: float = 120.0,
) -> Iterator[tuple[Job, Result | None]]:
    """Do all jobs, begun in their order; they come back as they are done.

    Args:
        what, unit: what is being done, and to what, for the reader.
        build: makes the function that does a job; called once in each process.
        jobs: what is to be done.
        workers: number of processes; None takes every core.
        time_limit_s: a worker that needs longer for a job is taken for stuck, and replaced (s).

    Returns:
        Each job with its result; None for one at which two workers failed.
    """
    waiting = list(reversed(jobs))
    with Progress(what, len(jobs), unit) as progress, Workers(build, workers, time_limit_s) as pool:
        while waiting or pool.busy:
            while waiting and pool.free:
                pool.give(waiting.pop())
            done = pool.wait(LOOK_EVERY_S)
            progress.advance(len(done))
            yield from done
