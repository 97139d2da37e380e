"""The curves and few figures of a training and an evaluation, which DVC shows and compares."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from sklearn.metrics import roc_curve

from preshape.errors import InputError
from preshape.evaluation.measured_files import (
    CURVES_FILE,
    METRICS_FILE,
    PREDICTIONS_FILE,
    read_figures,
    read_predictions,
)
from preshape.files import atomic_path, read_json, write_json

FIGURES = ("auc", "auc_low", "auc_high", "average_precision", "brier", "ece")


@dataclass(frozen=True)
class CurveTables:
    """Writes `learning.csv`, `roc.csv`, `reliability.csv` and `figures.json`.

    Args:
        run: folder of a training of a network that predicts success.
        evaluation: folder of the planners' comparison.
        output: folder of the tables.
    """

    run: Path | str
    evaluation: Path | str
    output: Path | str

    def write(self) -> str:
        """Write the tables, and say where they lie.

        Raises:
            InputError: if training or evaluation did not come to their end, or files cannot be read.
        """
        run, output = Path(self.run), Path(self.output)
        metrics = read_json(run / METRICS_FILE)
        if "reliability" not in metrics:
            fix = "choose a network that does, such as model=palm_points"
            raise InputError("The network does not predict success", where=run, fix=fix)
        tables = {
            "learning": pd.DataFrame(read_figures(run / CURVES_FILE, "points")["points"]),
            "roc": self._roc(run / PREDICTIONS_FILE),
            "reliability": _reliability(pd.DataFrame(metrics["reliability"])),
        }
        for name, table in tables.items():
            with atomic_path(output / f"{name}.csv") as temporary:
                table.to_csv(temporary, index=False, float_format="%.6g")
        planners = read_figures(Path(self.evaluation) / "evaluation.json", "planners")["planners"]
        write_json(output / "figures.json", _figures(metrics["scalars"], planners))
        return f"Curves of {run.name}: {output}"

    def _roc(self, file: Path) -> pd.DataFrame:
        predictions = read_predictions(file)
        false_positives, true_positives, _ = roc_curve(predictions["lifted"], predictions["success_prob"])
        return pd.DataFrame({"false_positive_rate": false_positives, "true_positive_rate": true_positives})


def _figures(scalars: Mapping[str, Any], planners: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """How well grasps are ranked, and what each planner lifted of the executed ones."""
    lifted = {name: planner["rate"] for name, planner in planners.items()}
    return {**{name: scalars[name] for name in FIGURES}, "lifted": lifted}


def _reliability(bins: pd.DataFrame) -> pd.DataFrame:
    """The bins into which a prediction fell."""
    return bins[bins["count"] > 0][["predicted", "observed", "low", "high", "count"]]
