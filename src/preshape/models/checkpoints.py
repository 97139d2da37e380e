"""Trained weights on disk: a safetensors file and a JSON sidecar that says what it holds.

Neither is ever executed: the network comes from the configuration, and the sidecar is only compared with it.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from preshape.errors import InputError
from preshape.files import atomic_path, read_json, write_json
from preshape.models.success_model import GraspNetwork

WEIGHTS_VERSION = 2
"""Version of the pair of files; raised whenever old ones could be misread."""
RETRAIN = "choose weights that `python src/train.py` wrote, or train again"


@dataclass(frozen=True)
class Sidecar:
    """What a weights file holds and where it comes from.

    Args:
        model, grasp_space: names of the network and of its grasp space.
        image_mean, image_std: statistics of the 8 image channels (colour 0-1, depth m, normal, curvature).
        data_hash: digest of the tables that it was trained on.
        git_revision: revision of the code.
        metrics: figures on held-out data, for the reader.
        weights_sha256: digest of the weights file.
    """

    model: str
    grasp_space: str
    image_mean: list[float]
    image_std: list[float]
    data_hash: str
    git_revision: str
    metrics: dict[str, Any] = field(default_factory=dict)
    weights_sha256: str = ""


def sidecar_path(weights: str | Path) -> Path:
    """Where the sidecar of a weights file lies: `model.safetensors.json` beside `model.safetensors`."""
    weights = Path(weights)
    return weights.with_name(weights.name + ".json")


def save_weights(
    path: str | Path,
    model: GraspNetwork,
    *,
    data_hash: str,
    git_revision: str,
    metrics: Mapping[str, Any],
) -> Sidecar:
    """Write the weights and input statistics of a network, and the sidecar, each atomically.

    Raises:
        InputError: if the place cannot be written to.
    """
    content = save({name: tensor.contiguous() for name, tensor in model.state_dict().items()})
    sidecar = Sidecar(
        model=model.name,
        grasp_space=model.grasp_space,
        image_mean=model.image_mean.tolist(),
        image_std=model.image_std.tolist(),
        data_hash=data_hash,
        git_revision=git_revision,
        metrics=dict(metrics),
        weights_sha256=hashlib.sha256(content).hexdigest(),
    )
    with atomic_path(path) as temporary:
        temporary.write_bytes(content)
    write_json(sidecar_path(path), {"version": WEIGHTS_VERSION, **asdict(sidecar)})
    return sidecar


def load_weights(path: str | Path, model: GraspNetwork) -> Sidecar:
    """Put weights into the network that the configuration built, and switch it to evaluation.

    Returns:
        The sidecar of the weights.

    Raises:
        InputError: if a file is missing, damaged, foreign, or belongs to another network or grasp space.
    """
    path = Path(path)
    content = _read_weights(path)
    sidecar = _read_sidecar(path)
    for what, found, wanted in (
        ("network", sidecar.model, model.name),
        ("grasp space", sidecar.grasp_space, model.grasp_space),
    ):
        if found != wanted:
            raise InputError(
                f"The weights belong to the {what} `{found}`, the configuration chose `{wanted}`",
                where=path,
                fix=f"choose weights of `{wanted}`, or configure `{found}`",
            )
    if hashlib.sha256(content).hexdigest() != sidecar.weights_sha256:
        raise InputError(
            "The weights file is damaged, or is not the one that its sidecar describes",
            where=path,
            fix=f"copy it again together with {sidecar_path(path).name}, or train again",
        )
    tensors = _parse(content, path)
    _check_tensors(tensors, model, path)
    model.load_state_dict(tensors)
    model.eval()
    return sidecar


def _read_weights(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        fix = "train a network first with `python src/train.py`, or correct `weights=`"
        raise InputError("There are no trained weights", where=path, fix=fix) from error
    except OSError as error:
        raise InputError(
            f"The weights cannot be read: {error.strerror or error}", where=path, fix="check the path"
        ) from error


def _read_sidecar(weights: Path) -> Sidecar:
    path = sidecar_path(weights)
    if not path.is_file():
        raise InputError(
            f"The weights lack their sidecar {path.name}, so nobody knows what they are",
            where=weights,
            fix="copy the sidecar beside them, or train again",
        )
    content = read_json(path)
    if content.pop("version", None) != WEIGHTS_VERSION:
        raise InputError("The sidecar is not of a version that this code reads", where=path, fix=RETRAIN)
    texts = ("model", "grasp_space", "data_hash", "git_revision", "weights_sha256")
    expected = {*texts, "image_mean", "image_std", "metrics"}
    if (
        set(content) != expected
        or not all(isinstance(content[key], str) for key in texts)
        or not all(_is_numbers(content[key]) for key in ("image_mean", "image_std"))
        or not isinstance(content["metrics"], dict)
    ):
        raise InputError("The sidecar does not describe weights of a network", where=path, fix=RETRAIN)
    return Sidecar(**content)


def _is_numbers(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(entry, float) for entry in value)


def _parse(content: bytes, path: Path) -> dict[str, Tensor]:
    try:
        tensors: dict[str, Tensor] = load(content)
    except (SafetensorError, ValueError, KeyError) as error:
        raise InputError(f"The file is not safetensors: {error}", where=path, fix=RETRAIN) from error
    return tensors


def _check_tensors(tensors: Mapping[str, Tensor], model: GraspNetwork, path: Path) -> None:
    expected = {name: (tensor.shape, tensor.dtype) for name, tensor in model.state_dict().items()}
    found = {name: (tensor.shape, tensor.dtype) for name, tensor in tensors.items()}
    if expected != found:
        different = sorted(
            name for name in expected.keys() | found.keys() if expected.get(name) != found.get(name)
        )
        named = ", ".join(different[:3]) + (f" and {len(different) - 3} more" if len(different) > 3 else "")
        raise InputError(
            f"The weights do not fit the configured `{model.name}`: {named} differ",
            where=path,
            fix="configure the network as it was when it was trained, or train again",
        )
    broken = sorted(name for name, tensor in tensors.items() if not torch.isfinite(tensor).all())
    if broken:
        raise InputError(f"The weights hold NaN or infinity: {', '.join(broken)}", where=path, fix=RETRAIN)
