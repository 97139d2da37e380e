"""What the table of a sweep says about trainings: the figures of each group of folds."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from preshape.evaluation.fold_summary import FoldResult
from preshape.evaluation.measured_files import METRICS_FILE
from preshape.files import read_json

FIGURES = {
    "auc": "AUC",
    "average_precision": "AP",
    "brier": "Brier",
    "ece": "ECE",
    "palm_m": "palm off by (m)",
}
"""Figures of the table and how they are called; of a network that predicts grasps, the palm's error."""
SMALLER_IS_BETTER = "palm_m"


class FoldTable:
    """A row of `runs.csv` for each fold, and one that is shown for each group and split, as `RunFigures`."""

    result_file = METRICS_FILE
    names = 3

    def rows(self, run: Path) -> list[dict[str, Any]]:
        """The one row of a fold; the folder above is that of its group."""
        result = FoldResult(run, read_json(run / self.result_file))
        scalars = result.scalars
        about = {
            "group": run.parent.name,
            "model": result.content["model"],
            "split": result.split,
            "fold": result.content["fold"],
            "n": int(scalars["n"]),
            "positives": int(scalars.get("positives", scalars["n"])),
        }
        return [{**about, **{key: scalars.get(key, float("nan")) for key in FIGURES}}]

    def best_first(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Folds by AUC; then those of networks that predict grasps, by the palm's error."""
        return _best_first(rows, "")

    def shown(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Means and standard deviations over the folds of each group and split."""
        spread = {f"{key}{part}": (key, how) for key in FIGURES for part, how in PARTS.items()}
        counts = {"folds": ("fold", "count"), "n": ("n", "sum"), "positives": ("positives", "sum")}
        grouped = rows.groupby(["group", "model", "split"], sort=False)
        groups = _best_first(grouped.agg(**counts, **spread).reset_index(), "_mean")
        figures = [key for key in FIGURES if rows[key].notna().any()]
        return pd.DataFrame(
            {
                "run": row["group"],
                "model": row["model"],
                "split": row["split"],
                "folds": f"{row['folds']}",
                "n": f"{row['n']:,}",
                "lifted": f"{row['positives']:,}",
                **{FIGURES[key]: _cell(row, key) for key in figures},
            }
            for row in groups.to_dict("records")
        )


def _best_first(table: pd.DataFrame, suffix: str) -> pd.DataFrame:
    by = [f"auc{suffix}", f"{SMALLER_IS_BETTER}{suffix}"]
    return table.sort_values(by, ascending=[False, True], kind="stable", ignore_index=True)


def _std(values: pd.Series) -> float:
    return float(values.std(ddof=0))


PARTS = {"_mean": "mean", "_std": _std}


def _cell(row: Mapping[Any, Any], key: str) -> str:
    """Mean and, of several folds, their standard deviation."""
    mean, std = row[f"{key}_mean"], row[f"{key}_std"]
    if mean != mean:
        return ""
    return f"{mean:.3f}" if row["folds"] == 1 else f"{mean:.3f} ± {std:.3f}"
