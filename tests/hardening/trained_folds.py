"""Folders of trained folds, without the training: good input for what reads them."""

from pathlib import Path

import numpy as np
import pandas as pd
import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.entry_point  # noqa: F401 - registers the resolvers
from preshape.checkpoints import save_weights
from preshape.data.folds import FOLDS
from preshape.evaluation.baselines import random_baseline
from preshape.evaluation.calibration import reliability_diagram
from preshape.evaluation.fold_summary import summarise
from preshape.evaluation.metrics import classification_metrics
from preshape.files import write_json
from preshape.measuring import PREDICTIONS_FILE, Measurement
from preshape.paths import project_root
from preshape.training import CURVES_FILE, METRICS_FILE, WEIGHTS_FILE


def write_rectangle_folds(place: Path, cornell: Path) -> None:
    """Write the folds of an untrained network for rectangles in images of the Cornell data.

    Args:
        place: where `src/detect.py` finds them as `runs`.
        cornell: the images.
    """
    conf = str(project_root() / "conf")
    with initialize_config_dir(conf, version_base="1.3"):
        cfg = compose("detect", [f"dataset.root={cornell}", f"paths.cache={place / 'cache'}"])
    torch.manual_seed(0)
    model = instantiate(cfg.model)
    data = instantiate(cfg.dataset.data)
    data.setup()
    for fold in range(FOLDS):
        folder = place / f"unseen_fold{fold}"
        save_weights(folder / WEIGHTS_FILE, model, data_hash=data.data_hash, git_revision="none", metrics={})
        _write_measurement(folder, "unseen", fold, {"data": data.data_hash})


def write_sweep(place: Path) -> None:
    """Write two folds as a sweep leaves them: what was measured, no weights."""
    identity = {"settings": "s", "data": "d", "code": "c"}
    for fold in range(2):
        _write_measurement(place / "palm_points" / f"unseen_fold{fold}", "unseen", fold, identity)
    summarise(place / "palm_points", identity)


def _write_measurement(folder: Path, split: str, fold: int, identity: dict[str, str]) -> None:
    rng = np.random.default_rng(fold)
    success_prob = rng.uniform(size=60)
    lifted = rng.uniform(size=60) < success_prob
    numbers = np.arange(60)
    folder.mkdir(parents=True, exist_ok=True)
    columns = {"trial_id": numbers, "scene_id": numbers, "lifted": lifted, "success_prob": success_prob}
    pd.DataFrame(columns).to_parquet(folder / PREDICTIONS_FILE)
    metrics = classification_metrics(lifted, success_prob, rng=rng)
    reliability = reliability_diagram(lifted, success_prob).to_dict()
    measured = Measurement(
        metrics, {"random": random_baseline(lifted, rng=rng)}, {"reliability": reliability}, {}
    )
    about = {"experiment": "default", "split": split, "fold": fold, "seed": 0, "model": "palm_points"}
    sizes = {"trials": None, "trials_learned": None, "identity": identity}
    write_json(folder / METRICS_FILE, {**about, **sizes, **measured.to_dict(), "scalars": measured.scalars()})
    write_json(folder / CURVES_FILE, {"points": [{"iteration": i, "train_loss": 1 / i} for i in (1, 2)]})
