"""Training: the seed decides the weights, an interruption changes nothing, every file comes out."""

import json
import signal
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch
from jaxtyping import Float
from synthetic_scenes import ORIGIN, BoxRenderer, allegro_space, write_data_set
from torch import Tensor, nn

from preshape.checkpoints import load_weights
from preshape.data.data_module import BatchSettings, GraspDataModule
from preshape.data.folds import HoldOut
from preshape.data.view_cache import ViewCache
from preshape.models.lightning_module import LearningSettings
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import SuccessModel
from preshape.perception.view_batch import ViewBatch
from preshape.tracking import TrackedRun, UntrackedRun
from preshape.training import TrainerSettings, predict, train

SETTINGS = TrainerSettings(
    LearningSettings(iterations=24, learning_rate=1e-2, schedule="steps", weight_decay=0.0, seed=0),
    accelerator="cpu",
    precision="32-true",
    keep_best=True,
)


class TinyNetwork(SuccessModel):
    """Mean colours and theta, one hidden layer and dropout: trains in milliseconds."""

    def __init__(self) -> None:
        super().__init__("tiny", "allegro_palm14", 14)
        self.layers = nn.Sequential(nn.Linear(8 + 14, 16), nn.Tanh(), nn.Dropout(0.25), nn.Linear(16, 1))

    def features(self, view: ViewBatch) -> Float[Tensor, "b 8"]:
        return self.normalize_patch(view.patch[:, :, ::40, ::40]).mean(dim=(2, 3))

    def raw_head(self, features: Float[Tensor, "f 8"], theta: Float[Tensor, "b 14"]) -> Float[Tensor, "b"]:
        joint = torch.cat((features.expand(len(theta), -1), self.normalize_theta(theta)), dim=1)
        return self.layers(joint).squeeze(1)


@pytest.fixture(scope="module")
def data_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    write_data_set(folder, 15)
    return folder


def make_data(folder: Path, validation_fraction: float) -> GraspDataModule:
    return GraspDataModule(
        folder=folder,
        origin=ORIGIN,
        space=allegro_space(),
        views=ViewCache(folder / "cache", BoxRenderer()),
        hold_out=HoldOut("scenes", fold=0, validation_fraction=validation_fraction, seed=0),
        batches=BatchSettings(batch_size=4, min_positives=1, batches_per_epoch=6, seed=0),
    )


@pytest.fixture
def data(data_folder: Path) -> GraspDataModule:
    return make_data(data_folder, validation_fraction=0.25)


def make_network(seed: int = 0) -> TinyNetwork:
    torch.manual_seed(seed)
    return TinyNetwork()


class CurvesInMemory(UntrackedRun):
    """Keeps the curves, and may interrupt the training."""

    def __init__(self, interrupt_at: int | None = None) -> None:
        self.steps: list[int] = []
        self.values: dict[str, float] = {}
        self.files: list[str] = []
        self._interrupt_at = interrupt_at

    def log(self, values: Mapping[str, float], step: int) -> None:
        if step == self._interrupt_at:
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


def test_an_interrupted_training_ends_with_the_same_weights(data: GraspDataModule, tmp_path: Path) -> None:
    undisturbed = trained(data, tmp_path / "undisturbed")
    disturbed = tmp_path / "disturbed"
    for step in (12, 18, 18):
        with pytest.raises(RuntimeError, match="lights"):
            trained(data, disturbed, run=CurvesInMemory(interrupt_at=step))
        assert [path.suffix for path in disturbed.iterdir()] == [".ckpt"]
    curves = CurvesInMemory()
    assert trained(data, disturbed, run=curves) == undisturbed
    assert 6 not in curves.steps
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


def test_every_file_comes_out_and_agrees(data: GraspDataModule, tmp_path: Path) -> None:
    curves = CurvesInMemory()
    result = train(make_network(), data, SETTINGS, tmp_path, curves)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "metrics.json",
        "model.safetensors",
        "model.safetensors.json",
        "predictions.parquet",
        "roc.png",
    }
    assert set(curves.files) == names
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    predictions = pd.read_parquet(tmp_path / "predictions.parquet")
    assert metrics["n"] == len(predictions) == len(data.test) == result.metrics.n
    assert metrics["auc"]["value"] == pytest.approx(curves.values["test_auc"])
    assert {"train_loss", "val_loss", "val_auc", "learning_rate"} <= set(curves.values)
    network = make_network(seed=5)
    sidecar = load_weights(result.weights, network)
    assert sidecar.data_hash == data.data_hash
    reloaded = predict(network, data.test_dataloader())
    assert np.array_equal(reloaded, predictions["success_prob"])


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
