"""Measuring a trained network on its held-out trials, and calibrating it before."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Bool, Float64
from torch.utils.data import DataLoader

from preshape.data.grasp_dataset import GraspBatch
from preshape.data.labelled_data import Examples, LabelledData
from preshape.data.trial_table import TrialTable
from preshape.evaluation.baselines import constant_baseline, random_baseline
from preshape.evaluation.calibration import fit_temperature, oversampling_shift, reliability_diagram
from preshape.evaluation.decisions import DecisionMetrics, best_f1_threshold, decision_metrics
from preshape.evaluation.grasp_errors import GraspErrors, grasp_errors
from preshape.evaluation.measured_files import PREDICTIONS_FILE
from preshape.evaluation.metrics import ClassificationMetrics, classification_metrics
from preshape.evaluation.reliability_picture import save_reliability
from preshape.evaluation.roc import save_roc
from preshape.files import atomic_path
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import GraspNetwork, SuccessModel

PICTURES = ("roc.png", "reliability.png")


@dataclass(frozen=True, eq=False)
class Measurement:
    """What a network came to on its test trials.

    Args:
        metrics: its figures.
        baselines: those of what knows nothing, by name.
        extra: what else is known, as it stands in the result file.
        extra_scalars: single numbers of that.
    """

    metrics: ClassificationMetrics | GraspErrors
    baselines: dict[str, ClassificationMetrics | GraspErrors]
    extra: dict[str, Any]
    extra_scalars: dict[str, float]

    def scalars(self) -> dict[str, float]:
        """All figures, those of the baselines with their name before: `random_auc`."""
        figures = self.metrics.scalars() | self.extra_scalars
        for baseline, metrics in self.baselines.items():
            figures |= {f"{baseline}_{name}": value for name, value in metrics.scalars().items()}
        return figures

    def to_dict(self) -> dict[str, Any]:
        """All figures as they stand in a result file."""
        baselines = {name: metrics.to_dict() for name, metrics in self.baselines.items()}
        return {**self.metrics.to_dict(), **self.extra, "baselines": baselines}


def calibrate(model: SuccessModel, data: LabelledData, *, prior_correction: bool) -> None:
    """Make a network's probabilities agree with observed rates, as far as moving and dividing logits can.

    Args:
        model: a trained network.
        data: its training trials, by which oversampling is undone, and its validation trials, to which the
            temperature is fitted; without any it stays 1.
        prior_correction: whether the oversampling of successes is undone.
    """
    shift, temperature = 0.0, 1.0
    if prior_correction:
        labels, batches = data.train.trials.lifted, data.batches
        shift = oversampling_shift(
            len(labels),
            int(labels.sum()),
            batch_size=batches.batch_size,
            min_positives=batches.min_positives,
        )
    if len(data.validation):
        model.calibrate(logit_shift=0.0, temperature=1.0)
        logits = predict_logits(model, data.val_dataloader()) + shift
        temperature = fit_temperature(data.validation.trials.lifted, logits)
    model.calibrate(logit_shift=shift, temperature=temperature)


def predict_logits(model: SuccessModel, loader: DataLoader[GraspBatch]) -> Float64[np.ndarray, "n"]:
    """Calibrated log odds of success of all trials of a loader, in its order."""
    model.eval()
    device = next(model.parameters()).device
    with torch.inference_mode():
        logits = [model(batch.view.to(device), batch.theta.to(device)) for batch in loader]
    return torch.cat(logits).double().cpu().numpy()


def predict(model: SuccessModel, loader: DataLoader[GraspBatch]) -> Float64[np.ndarray, "n"]:
    """Success probabilities of all trials of a loader, in its order."""
    return _probability(predict_logits(model, loader))


def measure(model: GraspNetwork, data: LabelledData, folder: Path, seed: int) -> Measurement:
    """Figures of a trained network on the test trials; writes predictions and pictures.

    Args:
        model: the network, calibrated.
        data: the trials.
        folder: where the files go.
        seed: seed of the resampling for the intervals, and of the random baseline.

    Raises:
        InputError: if the files cannot be written.
    """
    if isinstance(model, RegressionCNN):
        return _measure_grasps(model, data, folder)
    assert isinstance(model, SuccessModel)
    return _measure_success(model, data, folder, np.random.default_rng(seed))


def _measure_success(
    model: SuccessModel, data: LabelledData, folder: Path, rng: np.random.Generator
) -> Measurement:
    trials, groups = data.test.trials, data.test.trials.scene_ids
    labels = trials.lifted
    logits = predict_logits(model, data.test_dataloader())
    success_prob = _probability(logits)
    raw_logits = logits * model.temperature.item() - model.logit_shift.item()
    metrics = classification_metrics(labels, success_prob, rng=rng, groups=groups, threshold=data.threshold)
    baselines: dict[str, ClassificationMetrics | GraspErrors] = {
        "random": random_baseline(labels, rng=rng, groups=groups),
        "constant": constant_baseline(labels, data.train.trials.lifted, rng=rng, groups=groups),
    }
    diagram = reliability_diagram(labels, success_prob)
    before = _probability_errors(labels, _probability(raw_logits))
    calibration = {
        "logit_shift": model.logit_shift.item(),
        "temperature": model.temperature.item(),
        "before": before,
        "after": {"brier": metrics.brier, "ece": metrics.ece},
    }
    extra: dict[str, Any] = {"calibration": calibration, "reliability": diagram.to_dict()}
    scalars = {"temperature": model.temperature.item(), "logit_shift": model.logit_shift.item()}
    scalars |= {f"{name}_before_calibration": value for name, value in before.items()}
    if len(data.validation):
        chosen = _at_chosen_threshold(model, data, labels, success_prob)
        extra["chosen_threshold"] = asdict(chosen)
        scalars |= {f"{name}_chosen": value for name, value in asdict(chosen).items()}
    _save_predictions(folder, trials, lifted=labels, success_prob=success_prob, raw_logit=raw_logits)
    save_roc(folder / "roc.png", labels, success_prob, metrics)
    save_reliability(folder / "reliability.png", diagram)
    return Measurement(metrics, baselines, extra, scalars)


def _at_chosen_threshold(
    model: SuccessModel,
    data: LabelledData,
    labels: Bool[np.ndarray, "n"],
    success_prob: Float64[np.ndarray, "n"],
) -> DecisionMetrics:
    """Decisions on the test trials at the threshold that is best on the validation trials."""
    threshold = best_f1_threshold(data.validation.trials.lifted, predict(model, data.val_dataloader()))
    return decision_metrics(labels, success_prob, threshold)


def _measure_grasps(model: RegressionCNN, data: LabelledData, folder: Path) -> Measurement:
    model.eval()
    device = next(model.parameters()).device
    with torch.inference_mode():
        predicted = [model(batch.view.to(device)).double().cpu().numpy() for batch in data.test_dataloader()]
    theta = np.concatenate(predicted)
    _save_predictions(folder, data.test.trials, theta_predicted=list(theta))
    reached = data.test.trials.reached
    mean_grasp = np.broadcast_to(_mean_grasp(data.train), reached.shape)
    return Measurement(grasp_errors(theta, reached), {"constant": grasp_errors(mean_grasp, reached)}, {}, {})


def _mean_grasp(examples: Examples) -> Float64[np.ndarray, "d"]:
    """The mean of the grasps learned from, parameter by parameter."""
    mean: Float64[np.ndarray, "d"] = examples.trials.reached.mean(axis=0)
    return mean


def _probability_errors(
    labels: Bool[np.ndarray, "n"], success_prob: Float64[np.ndarray, "n"]
) -> dict[str, float]:
    """Brier score and expected calibration error."""
    return {
        "brier": float(np.mean((success_prob - labels) ** 2)),
        "ece": reliability_diagram(labels, success_prob).expected_error,
    }


def _probability(logits: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    return torch.sigmoid(torch.from_numpy(logits)).numpy()


def _save_predictions(folder: Path, trials: TrialTable, **predictions: Any) -> None:
    columns = trials.rows[["trial_id", "scene_id", "object_id"]].assign(**predictions)
    with atomic_path(folder / PREDICTIONS_FILE) as temporary:
        columns.to_parquet(temporary, index=False)
