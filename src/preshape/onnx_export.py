"""Success networks as ONNX files, for programs without PyTorch."""

from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor, nn

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.models.success_model import IMAGE_CHANNELS, GraspNetwork, SuccessModel
from preshape.perception.object_view import PATCH_SIZE
from preshape.perception.view_batch import ViewBatch

INPUTS = ("patch", "intrinsics", "theta")
OUTPUT = "logit"


def export_onnx(path: str | Path, model: GraspNetwork, grasps: int = 1) -> None:
    """Write a success network, its normalisation included, atomically.

    The file's inputs are those of a `ViewBatch` and theta for a fixed number b of grasps, each with its own
    view: `patch` (b, 8, 400, 400), `intrinsics` (b, 4) and `theta` (b, d), in single precision. Its output
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
    views = (torch.zeros(grasps, IMAGE_CHANNELS, PATCH_SIZE, PATCH_SIZE), torch.ones(grasps, 4))
    program = torch.onnx.export(
        _SeparateInputs(model).eval(),
        (*views, torch.ones(grasps, model.theta_dim)),
        input_names=list(INPUTS),
        output_names=[OUTPUT],
        dynamo=True,
        verbose=False,
    )
    assert program is not None, "PyTorch writes the file itself only if it is given its name"
    with atomic_path(path) as temporary:
        program.save(temporary, external_data=False)


class _SeparateInputs(nn.Module):
    """A success network that takes its inputs one by one."""

    def __init__(self, model: SuccessModel) -> None:
        super().__init__()
        self.model = model

    def forward(
        self, patch: Float[Tensor, "b 8 h w"], intrinsics: Float[Tensor, "b 4"], theta: Float[Tensor, "b d"]
    ) -> Float[Tensor, "b"]:
        logit: Tensor = self.model(ViewBatch(patch, intrinsics), theta)
        return logit
