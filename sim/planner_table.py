"""What the table of a sweep says about evaluations: how often each planner of each run lifted."""

from pathlib import Path
from typing import Any

import pandas as pd
from omegaconf import OmegaConf

from preshape.files import read_json
from preshape.provenance import command_line
from sim.evaluation import SUMMARY_FILE

SHOWN = ("scenes", "answered", "executed", "lifted", "rate", "low", "high", "predicted")
"""What stands in `runs.csv` of a planner's summary."""


class PlannerTable:
    """A row for each planner of each run, as `preshape.sweeps.run_table.RunFigures`."""

    result_file = SUMMARY_FILE
    names = 2

    def rows(self, run: Path) -> list[dict[str, Any]]:
        """The planners of an evaluation folder."""
        planners = read_json(run / SUMMARY_FILE)["planners"]
        return [
            {"run": _swept(run), "planner": name, **{key: summary[key] for key in SHOWN}}
            for name, summary in planners.items()
        ]

    def best_first(self, rows: pd.DataFrame) -> pd.DataFrame:
        """By lifted of executed; of equals, the surer one."""
        return rows.sort_values(["rate", "low"], ascending=False, kind="stable", ignore_index=True)

    def shown(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Rates with their 95 % intervals, and what the network had predicted."""
        return pd.DataFrame(
            {
                "run": row["run"],
                "planner": row["planner"],
                "scenes answered": f"{row['answered']} of {row['scenes']}",
                "executed": f"{row['executed']:,}",
                "lifted": f"{row['lifted']:,}",
                "rate": _rate(row),
                "predicted": _number(row["predicted"]),
            }
            for row in rows.to_dict("records")
        )


def _swept(run: Path) -> str:
    """The settings that tell a run from the others of its sweep: those that were not typed as they are."""
    file = run / ".hydra" / "overrides.yaml"
    chosen = [str(override) for override in OmegaConf.load(file)] if file.is_file() else []
    own = [override.partition("=") for override in chosen if override not in command_line().split()]
    return ", ".join(f"{key.rpartition('.')[2]}={value}" for key, _, value in own) or run.name


def _rate(row: dict[Any, Any]) -> str:
    rate = _number(row["rate"])
    return f"{rate} [{row['low']:.3f}, {row['high']:.3f}]" if rate else ""


def _number(value: float | None) -> str:
    """Three decimals; nothing where nothing was executed, or no network predicts."""
    return "" if value is None or value != value else f"{value:.3f}"
