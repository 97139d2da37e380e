"""How far long work has come: a bar on a terminal, a line now and then elsewhere."""

import logging
import sys
import time
from types import TracebackType

from tqdm import tqdm

log = logging.getLogger(__name__)


class Progress:
    """Progress towards a known total, with an estimate of the time left.

    Args:
        what: what is being done, for the reader.
        total: how many units there are.
        unit: what is counted.
        line_every_s: seconds between two lines where there is no terminal.
        done: units that were done before, which say nothing about the time left.
    """

    def __init__(
        self, what: str, total: int, unit: str = "it", line_every_s: float = 20.0, done: int = 0
    ) -> None:
        self._what, self._total, self._unit = what, total, unit
        self._every_s = line_every_s
        self._done = self._before = min(done, total)
        self._start = self._last_line = time.monotonic()
        terminal = sys.stderr.isatty()
        self._bar = (
            tqdm(total=total, desc=what, unit=unit, initial=self._done, dynamic_ncols=True)
            if terminal
            else None
        )

    def __enter__(self) -> "Progress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()

    def advance(self, units: int = 1, note: str = "") -> None:
        """Say that so many more units are done; more than the total counts as the total."""
        units = min(units, self._total - self._done)
        self._done += units
        if self._bar is not None:
            self._bar.set_postfix_str(note, refresh=False)
            self._bar.update(units)
            return
        now = time.monotonic()
        if now - self._last_line >= self._every_s or self._done >= self._total > self._done - units:
            self._last_line = now
            log.info("%s", self._line(now - self._start, note))

    def _line(self, elapsed_s: float, note: str) -> str:
        new = self._done - self._before
        if self._done >= self._total:
            end = f"{elapsed_s:.0f} s"
        elif new:
            left = elapsed_s * (self._total - self._done) / new
            end = f"{3600 * new / elapsed_s:.0f} per hour, about {left:.0f} s left"
        else:
            end = f"none new in {elapsed_s:.0f} s"
        text = f"{self._what}: {self._done} of {self._total} {self._unit}, {end}"
        return f"{text} ({note})" if note else text
