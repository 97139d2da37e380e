"""The table of a sweep: what its runs came to, the best first."""

import hashlib
import logging
import re
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import pandas as pd
from hydra.experimental.callback import Callback
from omegaconf import DictConfig

from preshape.files import atomic_path, exclusive
from preshape.provenance import command_line
from preshape.sweeps.sweep_folders import PLACES

RUNS_FILE, TABLE_FILE = "runs.csv", "runs.md"
WHERE_AND_WHO = ("hydra", "paths", "tracking")
LONGEST = 80

log = logging.getLogger(__name__)


@runtime_checkable
class RunFigures(Protocol):
    """What the table of a command's sweeps says about its runs."""

    @property
    def result_file(self) -> str:
        """The file that a run has when it is finished."""

    @property
    def names(self) -> int:
        """How many of the first columns that are shown are names; the others are numbers."""

    def rows(self, run: Path) -> list[dict[str, Any]]:
        """What a finished run came to, from its files: one row, or one for each of its parts."""

    def best_first(self, rows: pd.DataFrame) -> pd.DataFrame:
        """The rows of all runs in their order."""

    def shown(self, rows: pd.DataFrame) -> pd.DataFrame:
        """The same for people: cells of text under titles, the best first."""


def sweep_folder(runs: Path, command: str) -> Path:
    """Where the table of a sweep lies: the same whenever, and with whatever launcher, it is started.

    Args:
        runs: folder with the groups of all sweeps.
        command: what was typed.
    """
    words = sorted(word for word in command.split() if "=" in word)
    chosen = [word for word in words if re.split(r"[@/.=]", word)[0].lstrip("+~") not in WHERE_AND_WHO]
    text = " ".join(word for word in chosen if word.partition("=")[0] not in PLACES)
    name = re.sub(r"[^\w.=,+-]", "_", text) or "defaults"
    if len(name) > LONGEST:
        name = f"{name[: LONGEST - 9]}_{hashlib.sha256(text.encode()).hexdigest()[:8]}"
    return runs / "sweeps" / name


def join_table(sweep: Path, run: Path, figures: RunFigures) -> tuple[Path, Path]:
    """Put a finished run into the table of its sweep, which is written anew.

    Several processes may do so at the same time.

    Args:
        sweep: folder of the table, see `sweep_folder`.
        run: folder of the run, below the folder with all sweeps.
        figures: what the table says about runs.

    Returns:
        `runs.csv` with the rows of each run, and `runs.md`, the table that people read.

    Raises:
        InputError: if a file cannot be read or written.
    """
    runs = sweep.parents[1]
    with exclusive(sweep / ".lock"):
        known = pd.read_csv(sweep / RUNS_FILE)["folder"] if (sweep / RUNS_FILE).is_file() else ()
        names = sorted({*known, str(run.relative_to(runs))})
        finished = [name for name in names if (runs / name / figures.result_file).is_file()]
        rows = [{**row, "folder": name} for name in finished for row in figures.rows(runs / name)]
        table = figures.best_first(pd.DataFrame(rows))
        with atomic_path(sweep / RUNS_FILE) as temporary:
            table.to_csv(temporary, index=False)
        with atomic_path(sweep / TABLE_FILE) as temporary:
            temporary.write_text(_markdown(figures.shown(table), figures.names), encoding="utf-8")
    return sweep / RUNS_FILE, sweep / TABLE_FILE


class ShowRunTable(Callback):
    """Shows the table of a sweep when it has come to its end."""

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Show the table, and say where it lies."""
        table = sweep_folder(Path(config.hydra.sweep.dir), command_line()) / TABLE_FILE
        if table.is_file():
            log.info("Best first, in %s:\n\n%s", table, table.read_text(encoding="utf-8"))


def _markdown(table: pd.DataFrame, names: int) -> str:
    """A table of text, columns of numbers to the right."""
    rules = ["---"] * names + ["---:"] * (len(table.columns) - names)
    lines = [list(table.columns), rules, *table.to_numpy().tolist()]
    widths = [max(len(line[column]) for line in lines) for column in range(len(rules))]
    rows = (" | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)
    return "".join(f"| {row} |\n" for row in rows)
