"""Training a network and measuring it on held-out trials."""

import hashlib
import logging
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import lightning
import numpy as np
import torch
from jaxtyping import Float64
from safetensors.torch import save
from torch.utils.data import DataLoader

from preshape.checkpoints import save_weights, sidecar_path
from preshape.data.data_module import GraspDataModule
from preshape.data.grasp_dataset import GraspBatch
from preshape.data.trial_table import TrialTable
from preshape.evaluation.grasp_errors import GraspErrors, grasp_errors
from preshape.evaluation.metrics import ClassificationMetrics, classification_metrics
from preshape.evaluation.roc import save_roc
from preshape.files import atomic_path, write_json
from preshape.models.callbacks import KeepBest, Resumable, ShowProgress, TrackCurves
from preshape.models.lightning_module import LearningSettings, learning_of
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import GraspNetwork, SuccessModel
from preshape.provenance import git_revision, provenance
from preshape.tracking import TrackedRun

log = logging.getLogger(__name__)

WEIGHTS_FILE = "model.safetensors"
REPORT_FILES = ("predictions.parquet", "roc.png", "metrics.json")


@dataclass(frozen=True)
class TrainerSettings:
    """How and where to train.

    Args:
        learning: how the weights are fitted.
        accelerator: `cpu`, `gpu` or `auto`.
        precision: Lightning's name of the arithmetic, such as `32-true` or `bf16-mixed`.
        keep_best: whether to end with the weights of the lowest validation loss, rather than the last.
    """

    learning: LearningSettings
    accelerator: str
    precision: Literal["32-true", "16-mixed", "bf16-mixed"]
    keep_best: bool


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
    model: GraspNetwork, data: GraspDataModule, settings: TrainerSettings, folder: Path, run: TrackedRun
) -> TrainingResult:
    """Fit a network to the training trials and measure it on the test trials.

    A training that was interrupted goes on where it was, if it is started again with the same settings, data
    and folder. Everything is written at the end: weights with sidecar, predictions, the ROC picture of a
    network that predicts success, and last the metrics. The regression network learns from grasps that lifted
    alone, and is measured on such.

    Args:
        model: the network with its initial weights.
        data: the trials.
        settings: how and where to train.
        folder: where the files go.
        run: keeps curves and files.

    Raises:
        InputError: if the data cannot be used or the files cannot be written.
    """
    data.setup()
    if isinstance(model, RegressionCNN):
        data.keep_lifted()
    model.fit_statistics(data.train.patches(), data.train.theta)
    unfinished = folder / f"unfinished-{_identity(model, data, settings)}.ckpt"
    _fit(model, data, settings, unfinished, run)
    result = _measure(model, data, settings.learning, folder, run)
    for leftover in folder.glob("unfinished-*.ckpt"):
        leftover.unlink()
    return result


def predict(model: SuccessModel, loader: DataLoader[GraspBatch]) -> Float64[np.ndarray, "n"]:
    """Success probabilities of all trials of a loader, in its order."""
    model.eval()
    device = next(model.parameters()).device
    with torch.inference_mode():
        logits = [model(batch.view.to(device), batch.theta.to(device)) for batch in loader]
    return torch.sigmoid(torch.cat(logits).double()).cpu().numpy()


def _fit(
    model: GraspNetwork, data: GraspDataModule, settings: TrainerSettings, unfinished: Path, run: TrackedRun
) -> None:
    _quieten_lightning()
    validated = len(data.validation) > 0
    callbacks = [ShowProgress(), TrackCurves(run), Resumable(unfinished)]
    if settings.keep_best and validated:
        callbacks.insert(0, KeepBest())
    trainer = lightning.Trainer(
        accelerator=settings.accelerator,
        devices=1,
        precision=settings.precision,
        max_steps=settings.learning.iterations,
        max_epochs=-1,
        limit_val_batches=None if validated else 0,
        num_sanity_val_steps=0,
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
    except SystemExit as end:  # Lightning's answer to an interrupt
        if isinstance(end.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from end
        raise


def _measure(
    model: GraspNetwork, data: GraspDataModule, settings: LearningSettings, folder: Path, run: TrackedRun
) -> TrainingResult:
    """Metrics on the test trials; writes and keeps all files, the metrics last."""
    seed = settings.seed
    metrics: ClassificationMetrics | GraspErrors
    if isinstance(model, RegressionCNN):
        metrics = _measure_grasps(model, data, folder)
    else:
        assert isinstance(model, SuccessModel)
        metrics = _measure_success(model, data, seed, folder)
    weights = folder / WEIGHTS_FILE
    save_weights(
        weights, model, data_hash=data.data_hash, git_revision=git_revision(), metrics=metrics.to_dict()
    )
    write_json(folder / "metrics.json", {**provenance(seed), "model": model.name, **metrics.to_dict()})
    run.log({f"test_{name}": value for name, value in metrics.scalars().items()}, settings.iterations)
    for file in (weights, sidecar_path(weights), *(folder / name for name in REPORT_FILES)):
        if file.is_file():
            run.keep(file)
    return TrainingResult(metrics, weights)


def _measure_success(
    model: SuccessModel, data: GraspDataModule, seed: int, folder: Path
) -> ClassificationMetrics:
    trials = data.test.trials
    success_prob = predict(model, data.test_dataloader())
    metrics = classification_metrics(
        trials.lifted, success_prob, rng=np.random.default_rng(seed), groups=trials.scene_ids
    )
    _save_predictions(folder, trials, lifted=trials.lifted, success_prob=success_prob)
    save_roc(folder / "roc.png", trials.lifted, success_prob, metrics)
    return metrics


def _measure_grasps(model: RegressionCNN, data: GraspDataModule, folder: Path) -> GraspErrors:
    model.eval()
    device = next(model.parameters()).device
    with torch.inference_mode():
        predicted = [model(batch.view.to(device)).double().cpu().numpy() for batch in data.test_dataloader()]
    theta = np.concatenate(predicted)
    _save_predictions(folder, data.test.trials, theta_predicted=list(theta))
    return grasp_errors(theta, data.test.trials.reached)


def _save_predictions(folder: Path, trials: TrialTable, **predictions: Any) -> None:
    columns = trials.rows[["trial_id", "scene_id", "object_id"]].assign(**predictions)
    with atomic_path(folder / "predictions.parquet") as temporary:
        columns.to_parquet(temporary, index=False)


def _identity(model: GraspNetwork, data: GraspDataModule, settings: TrainerSettings) -> str:
    """Digest of all that decides the weights: initial weights, statistics, settings, data."""
    digest = hashlib.sha256(save({name: value.contiguous() for name, value in model.state_dict().items()}))
    digest.update(repr((settings, data.batches, data.data_hash)).encode())
    digest.update(data.train.trials.rows["trial_id"].to_numpy().tobytes())
    return digest.hexdigest()[:16]


def _quieten_lightning() -> None:
    """Leave out what Lightning says about hardware, workers and its maker's products."""
    for name in ("lightning.pytorch", "lightning.fabric"):
        logging.getLogger(name).setLevel(logging.ERROR)
    warnings.filterwarnings("ignore", module="lightning")
