"""The one error that a user can cause: bad input, said so that the user can mend it."""

import errno
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

ROOM, PERMISSION = (
    "free some space, or choose another place",
    "check the permissions, or choose another place",
)
REFUSALS = {
    **dict.fromkeys((errno.ENOSPC, errno.EDQUOT, errno.EFBIG), ROOM),
    **dict.fromkeys((errno.EACCES, errno.EPERM, errno.EROFS), PERMISSION),
}
"""What an operating system refuses for reasons that the user can mend, and how."""


class InputError(Exception):
    """Something that the user gave cannot be used.

    Entry points print it as one message and exit with status 2, without a traceback.

    Args:
        what: what is wrong, as a full sentence without its full stop.
        where: the file, folder or setting at fault.
        fix: what the user can do about it.
    """

    def __init__(self, what: str, *, where: str | Path, fix: str) -> None:
        self.what = what
        self.where = str(where)
        self.fix = fix
        super().__init__(f"{what}\n  where: {self.where}\n  fix:   {fix}")

    def __reduce__(self) -> tuple[Callable[[], "InputError"], tuple[()]]:
        # the default would call the class without its keywords when a worker process sends the error back
        return partial(InputError, self.what, where=self.where, fix=self.fix), ()


def bad_input_behind(error: BaseException | None) -> InputError | None:
    """The InputError that an exception is or was raised from, as `hydra.utils.instantiate` wraps it.

    A full disk and missing permissions are the user's to mend, too, wherever they were met.
    """
    while error is not None and not isinstance(error, InputError):
        if isinstance(error, OSError) and error.errno in REFUSALS:
            place = os.fsdecode(error.filename) if error.filename else "a file of this run"
            return InputError(os.strerror(error.errno), where=place, fix=REFUSALS[error.errno])
        error = error.__cause__
    return error
