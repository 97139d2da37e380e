"""Bad input is said completely, also out of a worker process."""

import errno
import os
from copy import copy

import pytest

from preshape.errors import InputError, bad_input_behind


def test_message_says_what_where_and_fix() -> None:
    error = InputError("The depth image is truncated", where="depth.png", fix="save it again")
    assert str(error).splitlines() == [
        "The depth image is truncated",
        "  where: depth.png",
        "  fix:   save it again",
    ]


def test_error_survives_the_way_between_processes() -> None:
    error = InputError("The depth image is truncated", where="depth.png", fix="save it again")
    arrived = copy(error)  # rebuilds it as a process does that receives it
    assert isinstance(arrived, InputError)
    assert (arrived.what, arrived.where, arrived.fix, str(arrived)) == (
        error.what,
        error.where,
        error.fix,
        str(error),
    )


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_what_the_machine_refuses_is_the_users_to_mend(number: int) -> None:
    for error in (OSError(number, "", "a/b"), wrapped(OSError(number, ""))):
        refusal = bad_input_behind(error)
        assert refusal is not None
        assert os.strerror(number) in refusal.what
        assert "another place" in refusal.fix


def test_other_errors_of_the_machine_are_defects() -> None:
    assert bad_input_behind(FileNotFoundError(errno.ENOENT, "", "a/b")) is None


def wrapped(error: Exception) -> Exception:
    try:
        raise RuntimeError from error
    except RuntimeError as outer:
        return outer
