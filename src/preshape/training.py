"""Training a network and measuring it on held-out trials."""

import hashlib
import logging
import os
import sys
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import lightning
from lightning.pytorch.utilities.exceptions import SIGTERMException
from safetensors.torch import save

from preshape.command_line.allocator import keep_freed_memory
from preshape.data.labelled_data import LabelledData
from preshape.evaluation.grasp_errors import GraspErrors
from preshape.evaluation.measured_files import CURVES_FILE, METRICS_FILE, PREDICTIONS_FILE
from preshape.evaluation.metrics import ClassificationMetrics
from preshape.files import write_json
from preshape.measuring import PICTURES, Measurement, calibrate, measure
from preshape.models.callbacks import KeepBest, Resumable, ShowProgress, TrackCurves
from preshape.models.checkpoints import load_weights, save_weights, sidecar_path
from preshape.models.lightning_module import LearningSettings, learning_of
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import GraspNetwork, SuccessModel
from preshape.provenance import git_revision, provenance
from preshape.tracking.tracked_run import TrackedRun

log = logging.getLogger(__name__)

WEIGHTS_FILE = "model.safetensors"
EXIT_TERMINATED = 143
"""What a shell calls the end by SIGTERM."""
REPORT_FILES = (PREDICTIONS_FILE, *PICTURES, CURVES_FILE, METRICS_FILE)


@dataclass(frozen=True)
class TrainerSettings:
    """How and where to train.

    Args:
        learning: how the weights are fitted.
        accelerator: `cpu`, `gpu` or `auto`.
        precision: Lightning's name of the arithmetic, such as `32-true` or `bf16-mixed`.
        keep_best: whether to end with the weights of the lowest validation loss, rather than the last.
        prior_correction: whether logits are moved to undo the oversampling of successes
            (`preshape.evaluation.calibration.oversampling_shift`).
        devices: how many GPUs, or processes on CPUs, train together.
    """

    learning: LearningSettings
    accelerator: str
    precision: Literal["32-true", "16-mixed", "bf16-mixed"]
    keep_best: bool
    prior_correction: bool = False
    devices: int = 1


@dataclass(frozen=True)
class TrainingResult:
    """What a training came to.

    Args:
        metrics: figures on the test trials.
        weights: file of the trained weights.
    """

    metrics: ClassificationMetrics | GraspErrors
    weights: Path


def train(
    model: GraspNetwork,
    data: LabelledData,
    settings: TrainerSettings,
    folder: Path,
    run: TrackedRun,
    description: Mapping[str, Any] | None = None,
) -> TrainingResult:
    """Fit a network to the training trials and measure it on the test trials.

    A training that was interrupted goes on where it was, if it is started again with the same settings, data
    and folder. Everything is written at the end: weights with sidecar, curves, predictions, pictures of a
    network that predicts success, and last the metrics. Such a network is calibrated before it is measured.
    The regression network learns from grasps that lifted alone, and is measured on such.

    Args:
        model: the network with its initial weights.
        data: the trials.
        settings: how and where to train.
        folder: where the files go.
        run: keeps curves and files.
        description: what else the file of the metrics shall say.

    Raises:
        InputError: if the data, or weights to start from, cannot be used, or files cannot be written.
    """
    keep_freed_memory()
    data.setup()
    if isinstance(model, RegressionCNN):
        data.keep_lifted()
    data.render(with_patches="patch" in model.looks_at)
    model.fit_statistics(data.train.patches(), data.train.theta)
    if settings.learning.start is not None:
        load_weights(settings.learning.start, model)  # with the statistics that they are used to
        model.train()
        if isinstance(model, SuccessModel):
            model.calibrate(logit_shift=0.0, temperature=1.0)
    unfinished = folder / f"unfinished-{_identity(model, data, settings)}.ckpt"
    curves = _fit(model, data, settings, unfinished, run)
    if isinstance(model, SuccessModel):
        calibrate(model, data, prior_correction=settings.prior_correction)
    write_json(folder / CURVES_FILE, {"points": curves})
    seed = settings.learning.seed
    measurement = measure(model, data, folder, seed)
    _keep(model, data, measurement, folder, description or {}, seed)
    scalars = {f"test_{name}": value for name, value in measurement.scalars().items()}
    run.log(scalars, settings.learning.iterations)
    keep_files(folder, run)
    for leftover in folder.glob("unfinished-*.ckpt"):
        leftover.unlink()
    return TrainingResult(measurement.metrics, folder / WEIGHTS_FILE)


def keep_files(folder: Path, run: TrackedRun) -> None:
    """Keep the files of a finished training with its run."""
    weights = folder / WEIGHTS_FILE
    for file in (weights, sidecar_path(weights), *(folder / name for name in REPORT_FILES)):
        if file.is_file():
            run.keep(file)


def _fit(
    model: GraspNetwork, data: LabelledData, settings: TrainerSettings, unfinished: Path, run: TrackedRun
) -> list[dict[str, float]]:
    """Fit the weights; returns the points of the curves."""
    _quieten_lightning()
    validated = len(data.validation) > 0
    curves = TrackCurves(run)
    callbacks = [*([ShowProgress()] if is_first_process() else []), curves, Resumable(unfinished)]
    if settings.keep_best and validated:
        callbacks.insert(0, KeepBest())
    trainer = lightning.Trainer(
        accelerator=settings.accelerator,
        devices=settings.devices,
        precision=settings.precision,
        max_steps=settings.learning.iterations,
        max_epochs=-1,
        limit_val_batches=None if validated else 0,
        num_sanity_val_steps=0,
        use_distributed_sampler=False,
        callbacks=callbacks,
        logger=False,
        enable_checkpointing=False,
        enable_progress_bar=False,
        enable_model_summary=False,
        default_root_dir=unfinished.parent,
    )
    going_on = unfinished.is_file()
    if going_on:
        log.info("Going on with the training that was interrupted: %s", unfinished)
    try:
        trainer.fit(
            learning_of(model, settings.learning),
            datamodule=data,
            ckpt_path=unfinished if going_on else None,
            weights_only=True,
        )
    except SIGTERMException:  # which would end the process as if it had done its work
        log.warning("Told to end by SIGTERM. Started again, this training goes on at its last validation.")
        sys.exit(EXIT_TERMINATED)
    except SystemExit as end:  # Lightning's answer to an interrupt
        if isinstance(end.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from end
        raise
    if not is_first_process():  # the first one measures and writes
        sys.exit(0)
    return curves.points


def is_first_process() -> bool:
    """Whether this is the only process, or the first of those that train together."""
    return os.environ.get("LOCAL_RANK", "0") == "0"  # set by Lightning for the others


def _keep(
    model: GraspNetwork,
    data: LabelledData,
    measurement: Measurement,
    folder: Path,
    description: Mapping[str, Any],
    seed: int,
) -> None:
    """Write weights, sidecar and, last of all, the metrics."""
    figures = measurement.metrics.to_dict()
    save_weights(
        folder / WEIGHTS_FILE, model, data_hash=data.data_hash, git_revision=git_revision(), metrics=figures
    )
    sizes = {"n_train": len(data.train), "n_validation": len(data.validation)}
    content = {**provenance(seed), "model": model.name, **description, **sizes, **measurement.to_dict()}
    content["scalars"] = measurement.scalars()
    write_json(folder / METRICS_FILE, content)


def _identity(model: GraspNetwork, data: LabelledData, settings: TrainerSettings) -> str:
    """Digest of all that decides the weights: initial weights, statistics, settings, data."""
    digest = hashlib.sha256(save({name: value.contiguous() for name, value in model.state_dict().items()}))
    digest.update(repr((settings, data.batches, data.data_hash)).encode())
    digest.update(data.train.trials.rows["trial_id"].to_numpy().tobytes())
    digest.update(data.train.labels.numpy().tobytes())
    return digest.hexdigest()[:16]


def _quieten_lightning() -> None:
    """Leave out what Lightning says about hardware, workers and its maker's products."""
    for name in ("lightning.pytorch", "lightning.fabric"):
        logging.getLogger(name).setLevel(logging.ERROR)
    warnings.filterwarnings("ignore", module="lightning")
