"""ONNX Runtime and PyTorch say the same of a grasp."""

from pathlib import Path

import numpy as np
import onnxruntime
import pytest
import torch
from synthetic_views import view_of

from preshape.errors import InputError
from preshape.hands.allegro import allegro_hand
from preshape.hands.jaws import Jaws
from preshape.models.config_cnn import ConfigCNN
from preshape.models.onnx_export import OUTPUT, export_onnx
from preshape.models.palm_points import PalmPoints
from preshape.models.patches_cnn import PatchesCNN
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import SuccessModel
from preshape.perception.gripper_frame import GripperFrame
from preshape.perception.hand_projection import HandProjection, RectangleProjection

SPACE = ("network", "allegro_palm14", 14)


def config_cnn() -> SuccessModel:
    return ConfigCNN(*SPACE)


def patches_cnn() -> SuccessModel:
    return PatchesCNN(*SPACE, projection=HandProjection(allegro_hand()))


def rectangle_patches() -> SuccessModel:
    projection = RectangleProjection(Jaws(), step_px=4)
    frame = GripperFrame(max_tilt_rad=0.5)
    return PatchesCNN("network", "rectangle4", 4, projection=projection, frame=frame)


def palm_points() -> SuccessModel:
    return PalmPoints(*SPACE)


@pytest.mark.parametrize("network", [config_cnn, patches_cnn, rectangle_patches, palm_points])
def test_onnx_runtime_agrees_with_torch(network: object, tmp_path: Path) -> None:
    torch.manual_seed(0)
    model = network().eval()
    view = view_of(torch.randn(2, 8, *model.view_size), [[525.0, 520.0, 200.0, 190.0]] * 2)
    theta = 0.1 * torch.randn(2, model.theta_dim)
    theta[:, 2] += 1.0
    if model.grasp_space == "rectangle4":
        theta = torch.tensor([[200.3, 180.2, 0.7, 40.0], [150.6, 210.9, 2.9, 55.0]])
    model.fit_statistics(view.patch, theta)
    export_onnx(tmp_path / "network.onnx", model, grasps=2)
    session = onnxruntime.InferenceSession(tmp_path / "network.onnx")
    inputs = {name: getattr(view, name).numpy() for name in model.looks_at} | {"theta": theta.numpy()}
    (logit,) = session.run([OUTPUT], inputs)
    with torch.no_grad():
        np.testing.assert_allclose(logit, model(view, theta).numpy(), rtol=1e-4, atol=1e-4)


def test_a_network_that_predicts_no_success_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not predict success"):
        export_onnx(tmp_path / "network.onnx", RegressionCNN(*SPACE))
    assert not list(tmp_path.iterdir())
