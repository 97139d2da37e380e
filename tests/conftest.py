"""What all tests share."""

import gc
import signal
from collections.abc import Iterator

import pytest
from ready_python import ReadyPython


def pytest_configure() -> None:
    """Let tests interrupt commands, although in a shell's background interrupts are ignored."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Never look through what was imported for garbage, which would take half a second each time."""
    gc.freeze()


def pytest_unconfigure() -> None:
    """Let libraries that count what is left at the end find nothing."""
    gc.unfreeze()


@pytest.fixture(scope="session")
def ready_python() -> Iterator[ReadyPython]:
    """A Python that commands start in within a second."""
    python = ReadyPython()
    yield python
    python.close()
