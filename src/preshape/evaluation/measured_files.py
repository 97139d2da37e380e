"""What trainings and evaluations measured, read from files that may be damaged, or others."""

from pathlib import Path
from typing import Any

import pandas as pd

from preshape.errors import InputError
from preshape.files import read_json

PREDICTIONS_FILE, CURVES_FILE, METRICS_FILE = "predictions.parquet", "curves.json", "metrics.json"
"""What a finished training leaves, in the order in which it is written."""


def read_figures(path: str | Path, *names: str) -> dict[str, Any]:
    """Read a JSON file that has to say something under each of these names.

    Raises:
        InputError: if the file cannot be read, or lacks a name.
    """
    content = read_json(path)
    missing = [name for name in names if name not in content]
    if missing:
        raise InputError(f"The file does not say {', '.join(missing)}", where=path, fix="make it again")
    return content


def read_predictions(path: str | Path) -> pd.DataFrame:
    """Read what a network predicted for the test trials of its fold.

    Returns:
        A table with `lifted` and `success_prob`, or with `theta_predicted` of a network that predicts grasps.

    Raises:
        InputError: if the file cannot be read, or is another table.
    """
    fix = "delete its folder and train the fold again"
    try:
        table = pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise InputError(f"The predictions cannot be read: {error}", where=path, fix=fix) from error
    if "theta_predicted" not in table and not {"lifted", "success_prob"} <= set(table):
        raise InputError("The table holds no predictions", where=path, fix=fix)
    return table
