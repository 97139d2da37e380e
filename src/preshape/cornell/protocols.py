"""The protocols of the Cornell data over trained folds: recognition and detection."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from preshape.cornell.data_module import CornellDataModule
from preshape.cornell.detection import Detection, Detector
from preshape.cornell.detection_rates import detection_rates
from preshape.data.folds import FOLDS, SplitScheme
from preshape.errors import InputError
from preshape.evaluation.measured_files import (
    METRICS_FILE,
    PREDICTIONS_FILE,
    read_figures,
    read_predictions,
)
from preshape.evaluation.metrics import classification_metrics
from preshape.files import write_json
from preshape.models.checkpoints import load_weights
from preshape.models.success_model import SuccessModel
from preshape.progress import Progress
from preshape.training import WEIGHTS_FILE

PROTOCOLS = {SplitScheme.SCENES: "image_wise", SplitScheme.UNSEEN: "object_wise"}
"""Names of the literature for the splits."""
DETECTIONS_FILE = "detections.json"
RECOGNITION = ("accuracy", "auc", "ap", "brier", "ece")

Parts = Callable[[str, int], tuple[CornellDataModule, SuccessModel]]
"""Data and network of a fold, by split and number."""


@dataclass(frozen=True, eq=False)
class FoldOutcome:
    """What came out of a fold.

    Args:
        split: how its images were held out.
        predictions: labels and predicted probabilities of its test rectangles.
        detections: what was proposed for its test images.
    """

    split: str
    predictions: pd.DataFrame
    detections: Sequence[Detection]


def evaluate_folds(group: Path, splits: Sequence[str], parts: Parts, detector: Detector) -> list[FoldOutcome]:
    """Detect in the test images of every trained fold; writes each fold's detections beside its weights.

    Args:
        group: folder of a sweep of `src/train.py`.
        splits: of which splits.
        parts: makes data and network of a fold.
        detector: proposes rectangles.

    Raises:
        InputError: if a fold was not trained, or was with other data.
    """
    folds = [(split, fold) for split in splits for fold in range(FOLDS)]
    folders = {key: group / f"{key[0]}_fold{key[1]}" for key in folds}
    _check_trained(folders.values())
    centres: dict[int, tuple[float, float]] = {}
    outcomes = []
    for (split, fold), folder in folders.items():
        data, model = parts(split, fold)
        detections = _detect(folder, data, model, detector, centres)
        content = {"detections": [own.to_dict() for own in detections]}
        write_json(folder / DETECTIONS_FILE, content)
        predictions = read_predictions(folder / PREDICTIONS_FILE)
        outcomes.append(FoldOutcome(split, predictions, detections))
    return outcomes


def _check_trained(folders: Iterable[Path]) -> None:
    missing = [folder for folder in folders if not (folder / METRICS_FILE).is_file()]
    if missing:
        raise InputError(
            f"{len(missing)} folds were not trained",
            where=missing[0],
            fix="train them with `python src/train.py --multirun` and the same model and dataset, "
            "split=scenes,unseen fold=0,1,2,3,4",
        )


def _detect(
    folder: Path,
    data: CornellDataModule,
    model: SuccessModel,
    detector: Detector,
    centres: dict[int, tuple[float, float]],
) -> list[Detection]:
    data.setup()
    if read_figures(folder / METRICS_FILE, "identity")["identity"].get("data") != data.data_hash:
        raise InputError(
            "The fold was trained with other data", where=folder, fix="train it again, or give its data"
        )
    data.render(with_patches=True)
    load_weights(folder / WEIGHTS_FILE, model)
    detections = []
    with Progress(f"Detecting, {folder.name}", len(data.test_images), "images") as progress:
        for image in data.test_images:
            number = image.files.number
            if number not in centres:
                centres[number] = detector.centre(image)
            detections += detector.detect(data.test.images[number], centres[number], model)
            progress.advance()
    return detections


def result_rows(name: str, outcomes: Sequence[FoldOutcome], seed: int) -> list[dict[str, Any]]:
    """Rows of the result file: for each protocol, recognition and then detection over all folds together.

    Recognition has bootstrap intervals over images, detection Wilson's.

    Args:
        name: of the data set.
        outcomes: of all folds.
        seed: of the bootstrap.
    """
    rows = []
    for split, protocol in PROTOCOLS.items():
        own = [outcome for outcome in outcomes if outcome.split == split]
        if own:
            head = {"data": name, "folds": protocol}
            found = detection_rates([outcome.detections for outcome in own])
            rows += [head | row for row in (*_recognition(own, seed), *found)]
    return rows


def _recognition(outcomes: Sequence[FoldOutcome], seed: int) -> list[dict[str, Any]]:
    table = pd.concat([outcome.predictions for outcome in outcomes])
    metrics = classification_metrics(
        table["lifted"].to_numpy(dtype=bool),
        table["success_prob"].to_numpy(dtype=float),
        rng=np.random.default_rng(seed),
        groups=table["scene_id"].to_numpy(),
        threshold=0.5,
    ).to_dict()
    rows = []
    for name in RECOGNITION:
        value = metrics[name]
        own = value if isinstance(value, Mapping) else _with_interval(value, metrics["intervals"].get(name))
        rows.append({"metric": f"recognition_{name}", **own, "n": metrics["n"]})
    return rows


def _with_interval(value: float, interval: Sequence[float] | None) -> dict[str, Any]:
    low, high = interval or (None, None)
    return {"value": value, "low": low, "high": high}
