"""Workers do every job, and are replaced when they fail."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import psutil
import pytest

from preshape.errors import InputError
from sim.workers import BeginStep, Work, Workers


def results(
    build: Callable[[], Work[Any, Any]], jobs: list[Any], count: int = 1, time_limit_s: float = 60.0
) -> dict[Any, Any]:
    """What comes of the jobs."""
    waiting, done = list(jobs), {}
    with Workers(build, count, time_limit_s) as workers:
        while waiting or workers.busy:
            while waiting and workers.free:
                workers.give(waiting.pop(0))
            done |= dict(workers.wait(1.0))
    return done


def always(work: Work[Any, Any]) -> Work[Any, Any]:
    return work


def square(number: int, begin: BeginStep) -> tuple[int, int]:
    return number**2, os.getpid()


@pytest.mark.parametrize("count", [1, 2])
def test_every_job_is_done_in_another_process(count: int) -> None:
    done = results(partial(always, square), list(range(7)), count)
    assert {job: value for job, (value, _) in done.items()} == {n: n**2 for n in range(7)}
    pids = {pid for _, pid in done.values()}
    assert len(pids) <= count
    assert os.getpid() not in pids


def die_once(mark: Path, number: int, begin: BeginStep) -> int:
    if number == 1 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_job_whose_worker_died_is_done_by_another(tmp_path: Path) -> None:
    work = partial(die_once, tmp_path / "died")
    assert results(partial(always, work), [0, 1, 2]) == {0: 0, 1: 1, 2: 2}
    assert (tmp_path / "died").exists()


def turn_for_ever() -> None:
    while True:
        pass


def fail_in_step_1(how: str, number: int, begin: BeginStep) -> list[int]:
    done = []
    for step in range(3):
        if begin(step):
            if number == 7 and step == 1:
                turn_for_ever() if how == "hang" else os.abort()
            done.append(step)
    return done


@pytest.mark.parametrize("how", ["hang", "abort"])
def test_a_step_in_which_two_workers_failed_is_left_out(how: str) -> None:
    done = results(partial(always, partial(fail_in_step_1, how)), [6, 7, 8], time_limit_s=1.0)
    assert done == {6: [0, 1, 2], 7: [0, 2], 8: [0, 1, 2]}


def wait_for(number: int, begin: BeginStep) -> int:
    time.sleep(number)
    return number


def test_a_job_that_does_nothing_is_given_up_later_than_one_that_works() -> None:
    assert results(partial(always, wait_for), [1, 60], time_limit_s=0.3) == {1: 1, 60: None}


def refuse() -> Work[int, int]:
    try:
        raise InputError("The folder holds no meshes", where="scans", fix="give another one")
    except InputError as error:  # as `hydra.utils.instantiate` would
        raise RuntimeError("wrapped") from error


def test_what_the_user_got_wrong_comes_out_of_the_workers() -> None:
    with pytest.raises(InputError, match="no meshes"):
        results(refuse, [0])


def divide(number: int, begin: BeginStep) -> float:
    return 1 / number


def test_a_defect_comes_out_with_its_traceback() -> None:
    with pytest.raises(RuntimeError, match="in divide"):
        results(partial(always, divide), [0])


def test_workers_that_cannot_start_are_refused() -> None:
    with pytest.raises(InputError, match="do not start"):
        results(os.abort, [0])


PARENT = """
from functools import partial
from sim.workers import Workers
from test_workers import always, wait_for

if __name__ == "__main__":
    with Workers(partial(always, wait_for), 1, 60.0) as workers:
        workers.give(0)
        while not workers.wait(1.0):
            pass
        workers.give(60)
        print("hangs", flush=True)
        workers.wait(60.0)
"""


def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    (tmp_path / "parent.py").write_text(PARENT)
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    with subprocess.Popen(
        [sys.executable, tmp_path / "parent.py"], env=environment, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == "hangs\n"
        children = psutil.Process(parent.pid).children()
        parent.kill()
    gone, alive = psutil.wait_procs(children, timeout=10)
    assert gone
    assert not alive
