"""patches-CNN for two fingers: where it looks, its size, its gradients, and what must not matter to it."""

import math

import numpy as np
import pytest
import torch
from torch import Tensor

from preshape.cornell.augmentation import mirror, mirrored_theta
from preshape.cornell.rectangle import GraspRectangle
from preshape.grasps.rectangle_space import rectangle_of, theta_of
from preshape.hands.jaws import Jaws
from preshape.models.patches_cnn import PatchesCNN
from preshape.perception.gripper_frame import GripperFrame
from preshape.perception.hand_projection import RectangleProjection
from preshape.perception.view_batch import ViewBatch

PROJECTION = RectangleProjection(Jaws())
FRAME = GripperFrame(max_tilt_rad=0.52)
SPACE = ("patches_cnn", "rectangle4", 4)
THETA = torch.tensor([[30.3, 22.4, 0.7, 12.0], [34.2, 25.4, 2.9, 16.0]], dtype=torch.float64)


def network(**settings: object) -> PatchesCNN:
    torch.manual_seed(0)
    small = {"palm_patch": 24, "finger_patch": 16, "palm_kernels": (6, 3)}
    return PatchesCNN(*SPACE, projection=PROJECTION, **(small | settings)).double().eval()


def smooth_image(seed: int = 0) -> Tensor:
    """An image without edges, where finite differences would depend on their step."""
    coarse = torch.randn(1, 8, 12, 16, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    return torch.nn.functional.interpolate(coarse, size=(48, 64), mode="bicubic")


@pytest.fixture
def view() -> ViewBatch:
    """A camera a metre over a table, 10 degrees off the vertical, and a wavy surface on it."""
    image = smooth_image()
    image[:, 3] = 0.95 + 0.02 * image[:, 3]
    facing = torch.tensor([0.0, 0.0, -3.0], dtype=torch.float64)[None, :, None, None]
    image[:, 4:7] = torch.nn.functional.normalize(image[:, 4:7] + facing, dim=1)
    intrinsics = torch.tensor([[130.0, 130.0, 30.0, 25.0]])
    table = torch.tensor([[0.0, -math.sin(0.17), -math.cos(0.17), 1.0]])
    return ViewBatch(image, intrinsics, torch.zeros(1, 0, 3), table, torch.eye(4)[None]).to(THETA)


def framed_signs(*, along: int, across: int) -> Tensor:
    """Of the channels: colours, curvature, height, normal, point."""
    axes = [along, across, 1]
    return torch.tensor([1, 1, 1, 1, 1, *axes, *axes], dtype=torch.float64)[:, None, None]


@pytest.mark.parametrize(("joint_layer", "count"), [(False, 315_961), (True, 319_001)])
def test_it_has_the_papers_number_of_parameters(joint_layer: bool, count: int) -> None:
    model = PatchesCNN(*SPACE, projection=PROJECTION, joint_layer=joint_layer)
    assert sum(parameter.numel() for parameter in model.parameters()) == count


def test_members_learn_by_themselves_and_their_probabilities_are_averaged(view: ViewBatch) -> None:
    model = network(members=3)
    logits = model.member_logits(view, THETA)
    torch.testing.assert_close(torch.sigmoid(model(view, THETA)), torch.sigmoid(logits).mean(dim=0))
    assert not torch.allclose(logits[0], logits[1])
    logits[1].sum().backward()
    for number, member in enumerate(model.members):
        gradients = [parameter.grad for parameter in member.parameters() if parameter.grad is not None]
        assert any(bool(gradient.any()) for gradient in gradients) == (number == 1)


@pytest.mark.parametrize("step_px", [1, 4])
def test_palm_and_fingertips_are_at_the_centre_and_the_jaws(step_px: int) -> None:
    corners = np.array([[100.0, 80.0], [130.0, 120.0], [114.0, 132.0], [84.0, 92.0]])
    rectangle = GraspRectangle.from_corners(corners)
    theta = torch.from_numpy(theta_of(rectangle))[None]
    hand = RectangleProjection(Jaws(), step_px)(theta, torch.zeros(1, 4))

    def in_view(pixels: np.ndarray) -> Tensor:
        return torch.from_numpy((pixels + 0.5) / step_px - 0.5)

    torch.testing.assert_close(hand.palm[0], in_view(corners.mean(axis=0)), atol=1e-5, rtol=0)
    jaws = np.stack((corners[[0, 3]].mean(axis=0), corners[[1, 2]].mean(axis=0)))
    torch.testing.assert_close(hand.fingertips[0], in_view(jaws), atol=1e-5, rtol=0)
    along_jaw = torch.from_numpy(corners[2] - corners[1])
    assert abs(hand.direction[0] @ along_jaw) == pytest.approx(along_jaw.norm().item())


def test_both_vertex_orders_are_the_same_grasp() -> None:
    corners = GraspRectangle(50.0, 40.0, 0.6, 30.0, 20.0).corners()
    other = corners[[1, 0, 3, 2]]
    one, same = (theta_of(GraspRectangle.from_corners(own)) for own in (corners, other))
    np.testing.assert_allclose(one, same)


@pytest.mark.parametrize("frame", [None, FRAME], ids=["camera", "gripper"])
def test_exact_gradient_agrees_with_the_papers_finite_differences(
    view: ViewBatch, frame: GripperFrame | None
) -> None:
    exact = network(frame=frame)
    differences = network(frame=frame, difference_steps=[1e-5] * 4)
    gradients = []
    for model in (exact, differences):
        theta = THETA.clone().requires_grad_()
        (gradient,) = torch.autograd.grad(model.raw_head(model.features(view), theta).sum(), theta)
        gradients.append(gradient)
    assert (gradients[0] != 0).all()
    torch.testing.assert_close(gradients[0], gradients[1], rtol=1e-3, atol=1e-7)


def test_finite_differences_of_the_papers_kind_point_the_same_way(view: ViewBatch) -> None:
    """With steps of a pixel, as images have them."""
    view = view._replace(patch=smooth_image())
    gradients = []
    for steps in (None, [1.0, 1.0, 0.02, 1.0]):
        model, theta = network(difference_steps=steps), THETA.clone().requires_grad_()
        (gradient,) = torch.autograd.grad(model.raw_head(model.features(view), theta).sum(), theta)
        gradients.append(gradient)
    cosine = torch.nn.functional.cosine_similarity(*gradients, dim=1)
    assert (cosine > 0.9).all()


def test_the_angle_goes_round(view: ViewBatch) -> None:
    """A full turn changes nothing, and there is no jump at 0, nor at half a turn."""
    model = network()
    features = model.features(view)
    turns = THETA + torch.tensor([0.0, 0.0, 2 * math.pi, 0.0], dtype=torch.float64)
    torch.testing.assert_close(model.raw_head(features, turns), model.raw_head(features, THETA))
    for angle in (0.0, math.pi):
        near = THETA[:1].repeat(2, 1)
        near[:, 2] = angle + torch.tensor([-1e-6, 1e-6], dtype=torch.float64)
        below, above = model.raw_head(features, near)
        assert below.item() == pytest.approx(above.item(), abs=1e-4)
        assert rectangle_of(near[0].numpy()).angle_rad == pytest.approx(math.pi, abs=1e-5)


def test_half_a_turn_exchanges_the_fingers_and_turns_the_patches(view: ViewBatch) -> None:
    model = network(frame=FRAME)
    features = model.features(view)
    palm, fingers = model._patches(features, THETA)
    turned_palm, turned_fingers = model._patches(
        features, THETA + torch.tensor([0.0, 0.0, math.pi, 0.0], dtype=torch.float64)
    )
    sign = framed_signs(along=-1, across=-1)
    torch.testing.assert_close(turned_palm, sign * palm.flip(-1, -2))
    torch.testing.assert_close(turned_fingers, sign * fingers.flip(1, -1, -2))


def test_a_mirrored_grasp_sees_mirrored_patches(view: ViewBatch) -> None:
    """So that its label is that of the grasp."""
    model = network(frame=FRAME)
    palm, fingers = model._patches(model.features(view), THETA)
    mirror(view, 0)
    other_palm, other_fingers = model._patches(model.features(view), mirrored_theta(THETA, width=64))
    sign = framed_signs(along=-1, across=1)
    torch.testing.assert_close(other_palm, sign * palm.flip(-1))
    torch.testing.assert_close(other_fingers, sign * fingers.flip(1, -1))


def test_theta_is_mirrored_as_rectangles_are() -> None:
    rectangle = GraspRectangle(100.0, 50.0, 0.4, 30.0, 20.0)
    theta = torch.from_numpy(theta_of(rectangle))[None]
    assert rectangle_of(mirrored_theta(theta)[0].numpy(), 20.0) == rectangle.mirrored(640)
