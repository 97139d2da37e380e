"""What one check found, and the process that a check may need."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """How bad it is."""

    OK = "OK"
    WARN = "WARN"
    """Works, but slower or less safely than it could."""
    FAIL = "FAIL"
    """Some command will not work."""


@dataclass(frozen=True)
class Finding:
    """What one check found.

    Args:
        name: what was looked at.
        status: how bad it is.
        detail: what is there.
        fix: what to do about it; empty where nothing is needed.
    """

    name: str
    status: Status
    detail: str
    fix: str = ""


Check = Callable[[], Finding]


@dataclass(frozen=True)
class ProbeResult:
    """How a probe ended: whether it succeeded, and what it printed; its last line of error if it failed."""

    succeeded: bool
    text: str


def probe(*arguments: str, timeout_s: float = 120.0) -> ProbeResult:
    """Run Python with these arguments in a process of its own, which may hang or crash without harm."""
    try:
        done = subprocess.run(
            (sys.executable, *arguments), capture_output=True, text=True, timeout=timeout_s, check=False
        )
    except subprocess.TimeoutExpired:
        return ProbeResult(False, f"no answer within {timeout_s:.0f} s")
    if done.returncode == 0:
        return ProbeResult(True, done.stdout.strip())
    last_words = done.stderr.strip().splitlines() or [f"ended with status {done.returncode}"]
    return ProbeResult(False, last_words[-1])
