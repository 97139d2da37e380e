"""How fast scenes were worked on."""

import logging
from dataclasses import dataclass
from pathlib import Path

from preshape.files import write_json
from preshape.provenance import provenance

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Effort:
    """What working on scenes took.

    Args:
        units: what was finished meanwhile, in the units of the goal, by everyone who works in the folder.
        seconds: wall-clock seconds, the workers' start included.
        workers: worker processes of this one.
    """

    units: int
    seconds: float
    workers: int

    @property
    def per_hour(self) -> float:
        """Units finished in an hour."""
        return 3600 * self.units / self.seconds

    def save(self, path: Path, seed: int, unit: str) -> None:
        """Write a result file, unless nothing was left to do.

        Args:
            path: the file.
            seed: seed of the run.
            unit: what was counted, in one word.

        Raises:
            InputError: if the file cannot be written.
        """
        if self.units == 0:
            return
        figures = {unit: self.units, "seconds": self.seconds, "workers": self.workers}
        write_json(path, provenance(seed) | figures | {f"{unit}_per_hour": self.per_hour})
        log.info("%.0f %s an hour with %d workers: %s", self.per_hour, unit, self.workers, path)
