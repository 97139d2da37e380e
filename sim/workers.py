"""Worker processes, one thread each, that keep what they need between jobs."""

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from itertools import islice
from typing import Any, TypeVar

from preshape.errors import bad_input_behind

Job = TypeVar("Job")
Result = TypeVar("Result")

# One process per core and one thread per process: more would only get in each other's way.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


def run_in_order(
    build: Callable[[], Callable[[Job], Result]], jobs: Iterator[Job], workers: int | None
) -> Iterator[Result]:
    """Results of the jobs, in their order, worked on by several processes.

    Only a few jobs are begun ahead of the result that is waited for, so `jobs` may be endless: stop taking
    results, and the workers stop.

    Args:
        build: makes the function that does a job; called once in each process. It and the jobs are pickled.
        jobs: what to do.
        workers: number of processes; 1 stays in this one, None takes every core.
    """
    workers = workers or available_cores()
    if workers <= 1:
        yield from map(build(), jobs)
        return
    os.environ.update(ONE_THREAD)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, _start_worker, (build,)) as pool:
        pending: list[Future[Result]] = [pool.submit(_do, job) for job in islice(jobs, 2 * workers)]
        try:
            while pending:
                result = pending.pop(0).result()
                pending.extend(pool.submit(_do, job) for job in islice(jobs, 1))
                yield result
        finally:
            pool.shutdown(cancel_futures=True)


_build: Callable[[], Callable[[Any], Any]]
_work: Callable[[Any], Any] | None = None


def _start_worker(build: Callable[[], Callable[[Any], Any]]) -> None:
    global _build
    _build = build


def _do(job: Any) -> Any:
    # Built by the first job, because an error while a worker starts would only be told as a broken pool.
    global _work
    if _work is None:
        try:
            _work = _build()
        except Exception as error:
            # only the error itself comes back to the parent, not what it was raised from
            bad_input = bad_input_behind(error)
            if bad_input is None:
                raise
            raise bad_input from None
    return _work(job)


def available_cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0))
