"""Folders of trained folds, without the training: good input for what reads them."""

from pathlib import Path

import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from synthetic_folds import write_fold, write_group

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from analysis.learning.fold_record import FoldRecord
from analysis.learning.runs import measured_folds
from preshape.data.folds import FOLDS
from preshape.models.checkpoints import save_weights
from preshape.paths import project_root
from preshape.training import WEIGHTS_FILE

ABOUT = {"experiment": "default", "model": "palm_points"}


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
        write_fold(folder, identity={"data": data.data_hash}, **ABOUT)


def write_sweep(place: Path) -> None:
    """Write two folds as a sweep leaves them: what was measured, no weights."""
    write_group(place / "palm_points", "unseen_fold0", "unseen_fold1", **ABOUT)


def write_record(place: Path, sweep: Path) -> None:
    """Record the folds of a sweep, as the report about learning does."""
    record = FoldRecord(place)
    with record.locked():
        for group, folds in measured_folds(sweep, [path.name for path in sweep.iterdir()]).items():
            record.take(group, folds)
