"""Workers give results in the order of the jobs, whatever their number."""

import os
from collections.abc import Callable
from itertools import count, islice

import pytest

from preshape.errors import InputError, bad_input_behind
from sim.workers import run_in_order


def squarer() -> Callable[[int], tuple[int, int]]:
    return square


def square(number: int) -> tuple[int, int]:
    return number**2, os.getpid()


@pytest.mark.parametrize("workers", [1, 2, None])
def test_results_come_in_order_from_endless_jobs(workers: int | None) -> None:
    results = list(islice(run_in_order(squarer, count(), workers), 7))
    assert [value for value, _ in results] == [n**2 for n in range(7)]


def test_work_is_done_in_other_processes() -> None:
    pids = {pid for _, pid in run_in_order(squarer, iter(range(4)), 2)}
    assert os.getpid() not in pids


def refuser() -> Callable[[int], int]:
    try:
        raise InputError("The folder holds no meshes", where="scans", fix="give another one")
    except InputError as error:  # as `hydra.utils.instantiate` would
        raise RuntimeError("wrapped") from error


@pytest.mark.parametrize("workers", [1, 2])
def test_what_the_user_got_wrong_comes_out_of_the_workers(workers: int) -> None:
    with pytest.raises((InputError, RuntimeError)) as refusal:
        next(run_in_order(refuser, count(), workers))
    assert bad_input_behind(refusal.value) is not None
