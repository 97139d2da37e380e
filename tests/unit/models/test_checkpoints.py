"""Weights files: what is written comes back, and nothing else is believed."""

import json
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest
import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from safetensors.torch import save_file

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from preshape.data.tables import data_hash
from preshape.errors import InputError
from preshape.models.checkpoints import load_weights, save_weights, sidecar_path
from preshape.models.config_cnn import ConfigCNN
from preshape.paths import project_root

SHIPPED = {
    "palm_points": ("allegro_grocery", "allegro_grocery_optima"),
    "config_cnn": ("allegro_grocery",),
}
"""Networks with shipped weights, and the data sets that they learned from."""


def make_model(
    seed: int = 0, name: str = "config_cnn", grasp_space: str = "allegro_palm14", theta_dim: int = 14
) -> ConfigCNN:
    torch.manual_seed(seed)
    return ConfigCNN(name, grasp_space, theta_dim)


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    path = tmp_path / "model.safetensors"
    save_weights(path, make_model(), data_hash="d", git_revision="g", metrics={"auc": 0.8})
    return path


def test_weights_and_statistics_come_back_to_the_bit(tmp_path: Path) -> None:
    path, model = tmp_path / "model.safetensors", make_model()
    model.fit_statistics(torch.randn(2, 8, 400, 400), torch.randn(9, 14))
    written = save_weights(path, model, data_hash="d", git_revision="g", metrics={"auc": 0.8})
    other = make_model(seed=1)
    assert load_weights(path, other) == written
    assert not other.training
    for name, tensor in model.state_dict().items():
        assert torch.equal(other.state_dict()[name], tensor), name


def edit_sidecar(path: Path, **changes: object) -> None:
    content = json.loads(sidecar_path(path).read_text())
    sidecar_path(path).write_text(json.dumps({**content, **changes}))


def flip_bit(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


class RunsWhenUnpickled:
    """A pickle that leaves a file behind wherever it is loaded."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Callable[[Path], None], tuple[Path]]:
        return Path.touch, (self.mark,)


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda path: path.unlink(), id="no weights"),
        pytest.param(lambda path: sidecar_path(path).unlink(), id="no sidecar"),
        pytest.param(lambda path: sidecar_path(path).write_text("{"), id="broken sidecar"),
        pytest.param(lambda path: edit_sidecar(path, version=99), id="other version"),
        pytest.param(lambda path: edit_sidecar(path, _target_="os.system"), id="_target_ in the sidecar"),
        pytest.param(lambda path: edit_sidecar(path, model=["config_cnn"]), id="mistyped sidecar"),
        pytest.param(lambda path: path.write_bytes(path.read_bytes()[:-100]), id="truncated"),
        pytest.param(lambda path: path.write_bytes(b""), id="empty"),
        pytest.param(flip_bit, id="flipped bit"),
        pytest.param(lambda path: save_file({"a": torch.zeros(2)}, path), id="foreign safetensors"),
    ],
)
def test_damaged_or_foreign_files_are_refused(weights: Path, damage: Callable[[Path], object]) -> None:
    damage(weights)
    with pytest.raises(InputError):
        load_weights(weights, make_model())


def with_matching_digest(path: Path, content: bytes) -> None:
    import hashlib

    path.write_bytes(content)
    edit_sidecar(path, weights_sha256=hashlib.sha256(content).hexdigest())


def test_a_pickle_is_refused_before_it_runs(weights: Path, tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    with_matching_digest(weights, pickle.dumps(RunsWhenUnpickled(mark)))
    with pytest.raises(InputError, match="not safetensors"):
        load_weights(weights, make_model())
    assert not mark.exists()


def test_weights_that_are_not_numbers_are_refused(tmp_path: Path) -> None:
    path, model = tmp_path / "model.safetensors", make_model()
    with torch.no_grad():
        next(model.parameters())[0] = torch.nan
    save_weights(path, model, data_hash="d", git_revision="g", metrics={})
    with pytest.raises(InputError, match="NaN"):
        load_weights(path, make_model())


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (make_model(name="regression"), "`config_cnn`.*`regression`"),
        (make_model(grasp_space="rectangle"), "`allegro_palm14`.*`rectangle`"),
        (make_model(theta_dim=4), "theta_channel.0.weight"),
    ],
)
def test_weights_of_another_network_are_refused(weights: Path, model: ConfigCNN, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_weights(weights, model)


@pytest.mark.parametrize("suffix", ["", "_unseen"])
@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_weights_fit_the_networks_and_tables(name: str, suffix: str) -> None:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("train", [f"model={name}"])
    shipped = load_weights(project_root() / "weights" / f"{name}{suffix}.safetensors", instantiate(cfg.model))
    assert shipped.data_hash == data_hash(*(Path(cfg.paths.data) / folder for folder in SHIPPED[name]))
