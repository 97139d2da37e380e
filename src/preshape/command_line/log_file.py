"""The log file of a run, which may end early, but does not disturb the run."""

import logging
import sys


class LogFile(logging.FileHandler):
    """A log file that ends, with one line that says so, where it can no longer be written: on a full disk."""

    _ended = False

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, unless the file has ended."""
        if not self._ended:
            super().emit(record)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (logging's own name)
        """End the file if it cannot be written; logging's own answer would be a traceback for each record."""
        error = sys.exc_info()[1]
        if not isinstance(error, OSError):
            super().handleError(record)
            return
        self._ended = True
        sys.stderr.write(f"WARNING: The log ends here: {error.strerror or error} ({self.baseFilename})\n")
