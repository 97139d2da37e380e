"""Metrics of a training, as `src/train.py` writes them."""

from pathlib import Path
from typing import Any

from preshape.errors import InputError
from preshape.files import read_json


def read_training_metrics(path: str | Path) -> dict[str, Any]:
    """Metrics of a training.

    Raises:
        InputError: if the file is missing or holds no AUC.
    """
    metrics = read_json(path)
    if not isinstance(metrics.get("auc"), dict) or not {"value", "low", "high"} <= set(metrics["auc"]):
        raise InputError(
            "The file holds no AUC with an interval",
            where=path,
            fix="give the metrics.json that `python src/train.py` wrote",
        )
    return metrics
