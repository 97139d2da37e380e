"""Success networks as ONNX files, for programs without PyTorch."""

from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.models.success_model import IMAGE_CHANNELS, GraspNetwork, SuccessModel
from preshape.perception.object_view import CLOUD_SIZE
from preshape.perception.view_batch import ViewBatch

OUTPUT = "logit"


def export_onnx(path: str | Path, model: GraspNetwork, grasps: int = 1) -> None:
    """Write a success network, its normalisation included, atomically.

    The file's inputs are what the network looks at (`GraspNetwork.looks_at`), in the shapes of a `ViewBatch`,
    and last `theta`, for a fixed number b of grasps, each with its own view, in single precision. Its output
    `logit` (b) is the log odds of success.

    Args:
        path: the file.
        model: the network.
        grasps: how many grasps b it judges at once.

    Raises:
        InputError: the network predicts something else than success, or the file cannot be written.
    """
    if not isinstance(model, SuccessModel):
        raise InputError(
            f"The network `{model.name}` does not predict success",
            where="model",
            fix="export a network that does, such as model=config_cnn",
        )
    example = _example(grasps, model.view_size)
    program = torch.onnx.export(
        _SeparateInputs(model, example).eval(),
        (*(getattr(example, name) for name in model.looks_at), torch.ones(grasps, model.theta_dim)),
        input_names=[*model.looks_at, "theta"],
        output_names=[OUTPUT],
        dynamo=True,
        verbose=False,
    )
    assert program is not None, "PyTorch writes the file itself only if it is given its name"
    with atomic_path(path) as temporary:
        program.save(temporary, external_data=False)


def _example(views: int, size: tuple[int, int]) -> ViewBatch:
    return ViewBatch(
        torch.zeros(views, IMAGE_CHANNELS, *size),
        torch.ones(views, 4),
        torch.zeros(views, CLOUD_SIZE, 3),
        torch.ones(views, 4),
        torch.eye(4).repeat(views, 1, 1),
    )


class _SeparateInputs(nn.Module):
    """A success network that takes one by one what it looks at, and then theta."""

    def __init__(self, model: SuccessModel, example: ViewBatch) -> None:
        super().__init__()
        self._model, self._example = model, example

    def forward(self, *inputs: Float[Tensor, "b ..."]) -> Float[Tensor, "b"]:
        *seen, theta = inputs
        view = self._example._replace(**dict(zip(self._model.looks_at, seen, strict=True)))
        logit: Tensor = self._model(view, theta)
        return logit
