"""An interrupt ends a command in one line and with status 130."""

import os
import signal
import sys
from types import FrameType
from typing import NoReturn

EXIT_INTERRUPTED = 130
"""As of a shell's command that SIGINT ended."""
STANDARD_ERROR = 2


def end_when_interrupted() -> None:
    """Let an interrupt end this process at once, which has begun nothing that it would have to end well.

    An exception might be lost in what a library that is being imported does about errors. Workers, which
    import the script as well, are left to the process that started them; an ignored interrupt stays ignored.
    """
    main = sys.modules["__main__"]
    is_script = hasattr(main, "__file__") and main.__spec__ is None
    if is_script and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def raise_interrupts() -> None:
    """Let an interrupt be a `KeyboardInterrupt` again, for who calls this handles it from now on."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def end_interrupted() -> NoReturn:
    """End this process at once. Nothing is torn down: SAPIEN dies of a scene that goes while it is drawn."""
    os.write(STANDARD_ERROR, b"Interrupted.\n")
    os._exit(EXIT_INTERRUPTED)


def _end(_number: int, _frame: "FrameType | None") -> None:
    end_interrupted()
