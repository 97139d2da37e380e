"""The table of a sweep: what its runs came to, the best first."""

import hashlib
import logging
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from hydra.experimental.callback import Callback
from omegaconf import DictConfig

from preshape.evaluation.fold_summary import FoldResult
from preshape.files import atomic_path, exclusive, read_json
from preshape.provenance import command_line
from preshape.sweep_folders import PLACES

RUNS_FILE, TABLE_FILE = "runs.csv", "runs.md"
FIGURES = {
    "auc": "AUC",
    "average_precision": "AP",
    "brier": "Brier",
    "ece": "ECE",
    "palm_m": "palm off by (m)",
}
"""Figures of the table and how they are called; of a network that predicts grasps, the palm's error."""
SMALLER_IS_BETTER = "palm_m"
WHERE_AND_WHO = ("hydra", "paths", "tracking")
LONGEST = 80

log = logging.getLogger(__name__)


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


def join_table(sweep: Path, run: Path) -> tuple[Path, Path]:
    """Put a finished run into the table of its sweep, which is written anew.

    Several processes may do so at the same time.

    Args:
        sweep: folder of the table, see `sweep_folder`.
        run: folder of the run; `metrics.json` lies in it, and the folder of its group is the one above.

    Returns:
        `runs.csv` with a row for each run, and `runs.md` with one for each group and split.

    Raises:
        InputError: if a file cannot be read or written.
    """
    runs = sweep.parents[1]
    with exclusive(sweep / ".lock"):
        known = pd.read_csv(sweep / RUNS_FILE)["folder"] if (sweep / RUNS_FILE).is_file() else ()
        folders = {*known, str(run.relative_to(runs))}
        rows = [_row(runs, name) for name in sorted(folders) if (runs / name / "metrics.json").is_file()]
        table = _best_first(pd.DataFrame(rows), "")
        with atomic_path(sweep / RUNS_FILE) as temporary:
            table.to_csv(temporary, index=False)
        with atomic_path(sweep / TABLE_FILE) as temporary:
            temporary.write_text(_markdown(table), encoding="utf-8")
    return sweep / RUNS_FILE, sweep / TABLE_FILE


class ShowRunTable(Callback):
    """Shows the table of a sweep when it has come to its end."""

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Show the table, and say where it lies."""
        table = sweep_folder(Path(config.hydra.sweep.dir), command_line()) / TABLE_FILE
        if table.is_file():
            log.info("Best first, in %s:\n\n%s", table, table.read_text(encoding="utf-8"))


def _row(runs: Path, name: str) -> dict[str, Any]:
    """What the table says of a run."""
    result = FoldResult(runs / name, read_json(runs / name / "metrics.json"))
    scalars = result.scalars
    positives = scalars.get("positives", scalars["n"])
    return {
        "group": Path(name).parent.name,
        "model": result.content["model"],
        "split": result.split,
        "fold": result.content["fold"],
        "n": int(scalars["n"]),
        "positives": int(positives),
        **{key: scalars.get(key, float("nan")) for key in FIGURES},
        "folder": name,
    }


def _best_first(table: pd.DataFrame, suffix: str) -> pd.DataFrame:
    """Rows by AUC; then those of networks that predict grasps, by the palm's error."""
    by = [f"auc{suffix}", f"{SMALLER_IS_BETTER}{suffix}"]
    return table.sort_values(by, ascending=[False, True], kind="stable", ignore_index=True)


def _markdown(table: pd.DataFrame) -> str:
    """Means and standard deviations over the folds of each group and split."""
    figures = [key for key in FIGURES if table[key].notna().any()]
    grouped = table.groupby(["group", "model", "split"], sort=False)
    spread = {f"{key}{part}": (key, how) for key in FIGURES for part, how in PARTS.items()}
    counts = {"folds": ("fold", "count"), "n": ("n", "sum"), "positives": ("positives", "sum")}
    groups = _best_first(grouped.agg(**counts, **spread).reset_index(), "_mean")
    header = ["run", "model", "split", "folds", "n", "lifted", *(FIGURES[key] for key in figures)]
    lines = [header, ["---"] * 3 + ["---:"] * (len(header) - 3)]
    for row in groups.to_dict("records"):
        counts_of_row = (f"{row['folds']}", f"{row['n']:,}", f"{row['positives']:,}")
        lines.append(
            [row["group"], row["model"], row["split"], *counts_of_row, *(_cell(row, key) for key in figures)]
        )
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    rows = (" | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)
    return "".join(f"| {row} |\n" for row in rows)


def _std(values: pd.Series) -> float:
    return float(values.std(ddof=0))


PARTS = {"_mean": "mean", "_std": _std}


def _cell(row: Mapping[Any, Any], key: str) -> str:
    """Mean and, of several folds, their standard deviation."""
    mean, std = row[f"{key}_mean"], row[f"{key}_std"]
    if mean != mean:
        return ""
    return f"{mean:.3f}" if row["folds"] == 1 else f"{mean:.3f} ± {std:.3f}"
