"""Bad input is said completely, also out of a worker process."""

from copy import copy

from preshape.errors import InputError


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
