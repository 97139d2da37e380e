"""The curves of a training as tables, which `dvc plots` draws and compares between revisions."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd
from sklearn.metrics import roc_curve

from preshape.errors import InputError
from preshape.files import atomic_path, read_json


@dataclass(frozen=True)
class CurveTables:
    """Writes `learning.csv`, `roc.csv` and `reliability.csv`.

    Args:
        run: folder of a training of a network that predicts success.
        output: folder of the tables.
    """

    run: Path | str
    output: Path | str

    def write(self) -> str:
        """Write the tables, and say where they lie.

        Raises:
            InputError: if the training did not come to its end, or its files cannot be read.
        """
        run, output = Path(self.run), Path(self.output)
        metrics = read_json(run / "metrics.json")
        if "reliability" not in metrics:
            fix = "choose a network that does, such as model=palm_points"
            raise InputError("The network does not predict success", where=run, fix=fix)
        tables = {
            "learning": pd.DataFrame(read_json(run / "curves.json")["points"]),
            "roc": self._roc(run / "predictions.parquet"),
            "reliability": _reliability(pd.DataFrame(metrics["reliability"])),
        }
        for name, table in tables.items():
            with atomic_path(output / f"{name}.csv") as temporary:
                table.to_csv(temporary, index=False, float_format="%.6g")
        return f"Curves of {run.name}: {output}"

    def _roc(self, file: Path) -> pd.DataFrame:
        try:
            predictions = pd.read_parquet(file)
        except (OSError, ValueError) as error:
            fix = "train the network again"
            raise InputError(f"The predictions cannot be read: {error}", where=file, fix=fix) from error
        false_positives, true_positives, _ = roc_curve(predictions["lifted"], predictions["success_prob"])
        return pd.DataFrame({"false_positive_rate": false_positives, "true_positive_rate": true_positives})


def _reliability(bins: pd.DataFrame) -> pd.DataFrame:
    """The bins into which a prediction fell."""
    return bins[bins["count"] > 0][["predicted", "observed", "low", "high", "count"]]
