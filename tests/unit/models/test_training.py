"""Training: the seed decides the weights, an interruption changes nothing, every file comes out."""

import json
import os
import signal
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch
from scipy.special import expit
from synthetic_scenes import write_data_set
from tiny_training import SETTINGS, make_data, make_network

from preshape.data.data_module import GraspDataModule
from preshape.evaluation.calibration import fit_temperature
from preshape.measuring import measure, predict
from preshape.models.checkpoints import load_weights
from preshape.models.regression_cnn import RegressionCNN
from preshape.tracking.tracked_run import TrackedRun, UntrackedRun
from preshape.training import train


@pytest.fixture(scope="module")
def data_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    write_data_set(folder, 15)
    return folder


@pytest.fixture
def data(data_folder: Path) -> GraspDataModule:
    return make_data(data_folder, validation_fraction=0.25)


class CurvesInMemory(UntrackedRun):
    """Keeps the curves, and may interrupt the training."""

    def __init__(self, interrupt_at: int | None = None, before: str = "train_loss") -> None:
        self.steps: list[int] = []
        self.values: dict[str, float] = {}
        self.files: list[str] = []
        self._interruption = interrupt_at, before

    def log(self, values: Mapping[str, float], step: int) -> None:
        iteration, before = self._interruption
        if step == iteration and before in values:
            raise RuntimeError("the lights went out")
        self.steps.append(step)
        self.values.update(values)

    def keep(self, file: Path) -> None:
        self.files.append(file.name)


def trained(data: GraspDataModule, folder: Path, seed: int = 0, run: TrackedRun | None = None) -> bytes:
    settings = replace(SETTINGS, learning=replace(SETTINGS.learning, seed=seed))
    result = train(make_network(seed), data, settings, folder, run or UntrackedRun())
    return result.weights.read_bytes()


def test_a_seed_decides_the_weights(data: GraspDataModule, tmp_path: Path) -> None:
    first, again, other = (trained(data, tmp_path / f"{i}", seed) for i, seed in enumerate((0, 0, 1)))
    assert first == again
    assert first != other


def test_learning_on_begins_with_the_other_weights_and_their_statistics(
    data: GraspDataModule, data_folder: Path, tmp_path: Path
) -> None:
    trained(data, tmp_path / "first")
    start = tmp_path / "first" / "model.safetensors"
    other = make_data(data_folder, validation_fraction=0.0, fold=1)
    learning = replace(SETTINGS.learning, start=str(start), learning_rate=0.0)
    settings = replace(SETTINGS, learning=learning)
    result = train(make_network(7), other, settings, tmp_path / "second", UntrackedRun())
    given, found = make_network(1), make_network(2)
    load_weights(start, given)
    load_weights(result.weights, found)
    assert given.temperature != 1
    assert found.temperature == 1, "the calibration of other data is not kept"
    given.calibrate(logit_shift=0.0, temperature=1.0)
    for name, value in given.state_dict().items():
        assert torch.equal(value, found.state_dict()[name]), name


@pytest.mark.parametrize("validation_fraction", [0.25, 0.0])
def test_an_interrupted_training_ends_with_the_same_weights(
    data_folder: Path, tmp_path: Path, validation_fraction: float
) -> None:
    data = make_data(data_folder, validation_fraction=validation_fraction)
    undisturbed = trained(data, tmp_path / "undisturbed")
    disturbed = tmp_path / "disturbed"
    for step, before in ((12, "train_loss"), (18, "train_loss"), (18, "train_loss"), (24, "test_auc")):
        with pytest.raises(RuntimeError, match="lights"):
            trained(data, disturbed, run=CurvesInMemory(step, before))
        assert len(list(disturbed.glob("*.ckpt"))) == 1
    curves = CurvesInMemory()
    assert trained(data, disturbed, run=curves) == undisturbed
    assert 6 not in curves.steps
    assert (disturbed / "curves.json").read_bytes() == (tmp_path / "undisturbed/curves.json").read_bytes()
    assert not list(disturbed.glob("*.ckpt"))


def test_the_best_weights_are_kept(data: GraspDataModule, tmp_path: Path) -> None:
    class Losses(UntrackedRun):
        losses: list[float] = []  # noqa: RUF012

        def log(self, values: Mapping[str, float], step: int) -> None:
            if "val_loss" in values:
                self.losses.append(values["val_loss"])

    learning = replace(SETTINGS.learning, learning_rate=1.0)
    for keep_best, choose in ((True, min), (False, lambda losses: losses[-1])):
        Losses.losses.clear()
        settings = replace(SETTINGS, learning=learning, keep_best=keep_best)
        network = make_network()
        train(network, data, settings, tmp_path / str(keep_best), Losses())
        assert len(set(Losses.losses)) == 4
        network.calibrate(logit_shift=0.0, temperature=1.0)
        probability = predict(network, data.val_dataloader())
        labels = data.validation.trials.lifted
        loss = -np.log(np.where(labels, probability, 1 - probability)).mean()
        assert loss == pytest.approx(choose(Losses.losses), rel=1e-4)


def test_regression_learns_from_grasps_that_lifted(data: GraspDataModule, tmp_path: Path) -> None:
    torch.manual_seed(0)
    model = RegressionCNN("regression", "allegro_palm14", 14)
    settings = replace(SETTINGS, learning=replace(SETTINGS.learning, iterations=6))
    result = train(model, data, settings, tmp_path, UntrackedRun())
    assert all(part.trials.lifted.all() for part in (data.train, data.validation, data.test))
    predictions = pd.read_parquet(tmp_path / "predictions.parquet")
    assert result.metrics.n == len(predictions) == len(data.test) > 0
    assert np.stack(predictions["theta_predicted"]).shape == data.test.trials.reached.shape
    assert load_weights(result.weights, model).metrics == result.metrics.to_dict()


def test_an_interrupt_stays_an_interrupt(data: GraspDataModule, tmp_path: Path) -> None:
    class Interrupting(UntrackedRun):
        def log(self, values: Mapping[str, float], step: int) -> None:
            raise KeyboardInterrupt

    handler = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(KeyboardInterrupt):
            train(make_network(), data, SETTINGS, tmp_path, Interrupting())
    finally:
        signal.signal(signal.SIGINT, handler)
    assert not list(tmp_path.glob("model*"))


def test_being_told_to_end_is_no_success(data: GraspDataModule, tmp_path: Path) -> None:
    class Terminating(UntrackedRun):
        def log(self, values: Mapping[str, float], step: int) -> None:
            os.kill(os.getpid(), signal.SIGTERM)

    handler = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.raises(SystemExit) as end:
            train(make_network(), data, SETTINGS, tmp_path, Terminating())
    finally:
        signal.signal(signal.SIGTERM, handler)
    assert end.value.code == 143
    assert not list(tmp_path.glob("model*"))
    assert list(tmp_path.glob("unfinished-*.ckpt"))


def test_every_file_comes_out_and_agrees(data: GraspDataModule, tmp_path: Path) -> None:
    curves = CurvesInMemory()
    result = train(make_network(), data, SETTINGS, tmp_path, curves)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "curves.json",
        "metrics.json",
        "model.safetensors",
        "model.safetensors.json",
        "predictions.parquet",
        "reliability.png",
        "roc.png",
    }
    assert set(curves.files) == names
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    predictions = pd.read_parquet(tmp_path / "predictions.parquet")
    assert metrics["n"] == len(predictions) == len(data.test) == result.metrics.n
    assert metrics["auc"]["value"] == pytest.approx(curves.values["test_auc"])
    assert {"train_loss", "val_loss", "val_auc", "learning_rate"} <= set(curves.values)
    assert {"test_brier_low", "test_random_auc", "test_constant_brier", "test_f1_chosen"} <= set(
        curves.values
    )
    assert set(metrics["baselines"]) == {"random", "constant"}
    points = json.loads((tmp_path / "curves.json").read_text())["points"]
    assert [point["iteration"] for point in points] == [6, 12, 18, 24]
    network = make_network(seed=5)
    sidecar = load_weights(result.weights, network)
    assert sidecar.data_hash == data.data_hash
    reloaded = predict(network, data.test_dataloader())
    assert np.array_equal(reloaded, predictions["success_prob"])


def test_probabilities_are_calibrated_on_validation_trials(data: GraspDataModule, tmp_path: Path) -> None:
    network = make_network()
    train(network, data, replace(SETTINGS, prior_correction=True), tmp_path, UntrackedRun())
    shift, temperature = network.logit_shift.item(), network.temperature.item()
    assert shift < 0  # each batch has a lifted grasp
    predictions = pd.read_parquet(tmp_path / "predictions.parquet")
    calibrated = expit((predictions["raw_logit"] + shift) / temperature)
    np.testing.assert_allclose(predictions["success_prob"], calibrated, rtol=1e-5)
    network.calibrate(logit_shift=shift, temperature=1.0)
    probability = predict(network, data.val_dataloader())
    logits = np.log(probability / (1 - probability))
    assert temperature == pytest.approx(fit_temperature(data.validation.trials.lifted, logits), rel=1e-3)


def test_figures_do_not_depend_on_the_batch_size(data_folder: Path, tmp_path: Path) -> None:
    network = make_network()
    figures = []
    for batch_size in (1, 7):
        data = make_data(data_folder, 0.25, batch_size=batch_size)
        data.setup()
        figures.append(measure(network, data, tmp_path, seed=0).scalars())
    assert figures[0] == pytest.approx(figures[1], rel=1e-5, nan_ok=True)


def test_the_learning_rate_drops_after_each_third(data: GraspDataModule, tmp_path: Path) -> None:
    class LearningRates(UntrackedRun):
        rates: dict[int, float] = {}  # noqa: RUF012

        def log(self, values: Mapping[str, float], step: int) -> None:
            self.rates.setdefault(step, values.get("learning_rate", np.nan))

    train(make_network(), data, SETTINGS, tmp_path, LearningRates())
    assert LearningRates.rates == pytest.approx({6: 1e-2, 12: 1e-3, 18: 1e-4, 24: 1e-4})


def test_all_that_is_not_tested_can_be_learned_from(data_folder: Path, tmp_path: Path) -> None:
    data = make_data(data_folder, validation_fraction=0.0)
    curves = CurvesInMemory()
    train(make_network(), data, SETTINGS, tmp_path, curves)
    assert len(data.validation) == 0
    assert "train_loss" in curves.values
    assert "val_loss" not in curves.values
