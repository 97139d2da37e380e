"""Every network that predicts success: its size, its split into features and head, its gradients."""

from collections.abc import Callable

import pytest
import torch
from scipy.spatial.transform import Rotation
from synthetic_views import view_of
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from preshape.hands.allegro import allegro_hand
from preshape.hands.kinematics import HandKinematics
from preshape.models.config_cnn import ConfigCNN
from preshape.models.ensemble import logit_of_mean
from preshape.models.palm_points import PalmPoints
from preshape.models.patches_cnn import PatchesCNN
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import SuccessModel
from preshape.perception.hand_projection import HandProjection
from preshape.perception.view_batch import ViewBatch

HAND = allegro_hand()
SPACE = ("network", "allegro_palm14", 14)
NETWORKS: dict[str, Callable[[], SuccessModel]] = {
    "fixed on the object": lambda: ConfigCNN(*SPACE),
    "moving with the palm": lambda: ConfigCNN(*SPACE, hand=HAND),
    "patches of the hand": lambda: PatchesCNN(*SPACE, projection=HandProjection(HAND)),
    "points in the palm's frame": lambda: PalmPoints(*SPACE),
}


@pytest.fixture(params=list(NETWORKS))
def model(request: pytest.FixtureRequest) -> SuccessModel:
    torch.manual_seed(0)
    return NETWORKS[request.param]().eval()


@pytest.fixture
def view() -> ViewBatch:
    """Two images without edges, where finite differences would depend on their step."""
    coarse = torch.randn(2, 8, 40, 40, generator=torch.Generator().manual_seed(1))
    patch = torch.nn.functional.interpolate(coarse, size=400, mode="bicubic")
    return view_of(patch, [[525.0, 525.0, 200.0, 190.0], [525.0, 530.0, 150.0, 200.0]])


@pytest.fixture
def theta() -> Tensor:
    """Grasps of different orientations about a metre before the camera."""
    theta = 0.3 * torch.randn(2, 14, generator=torch.Generator().manual_seed(2))
    theta[:, :3] = 0.1 * theta[:, :3] + torch.tensor([0.0, 0.0, 1.0])
    return theta


def first(view: ViewBatch) -> ViewBatch:
    return ViewBatch(*(part[:1] for part in view))


def parameters(model: torch.nn.Module) -> int:
    return sum(parameter.numel() for parameter in model.parameters())


def two_fingers() -> HandProjection:
    """Index finger and thumb of the Allegro hand."""
    hand = allegro_hand()
    for name in ("origins", "cross", "theta_index"):
        setattr(hand, name, getattr(hand, name)[[0, 3]])
    return HandProjection(hand)


@pytest.mark.parametrize(
    ("projection", "joint_layer", "count"),
    [
        (two_fingers(), False, 315_961),
        (two_fingers(), True, 319_001),
        (HandProjection(HAND), False, 425_737),
        (HandProjection(HAND), True, 430_761),
    ],
)
def test_patches_cnn_has_the_papers_number_of_parameters(
    projection: HandProjection, joint_layer: bool, count: int
) -> None:
    assert parameters(PatchesCNN(*SPACE, projection=projection, joint_layer=joint_layer)) == count


@pytest.mark.parametrize("hand", [None, HAND])
def test_config_cnn_has_the_papers_number_of_parameters(hand: HandKinematics | None) -> None:
    assert parameters(ConfigCNN(*SPACE, hand=hand)) == 61_065


def test_config_cnn_is_the_papers_convolution_of_tiled_features(view: ViewBatch, theta: Tensor) -> None:
    model = ConfigCNN(*SPACE).eval()
    m = model.image_channel(model.normalize_patch(view.patch))
    n = model.theta_channel(model.normalize_theta(theta))
    joined = model.joint_convolution(torch.cat((m, n[:, :, None, None].expand(-1, -1, 25, 25)), dim=1))
    logits = model.joint_channel(joined)[:, 0]
    torch.testing.assert_close(model.raw_head(model.features(view), theta), logits, rtol=1e-4, atol=1e-5)


def test_regression_has_the_papers_number_of_parameters() -> None:
    assert parameters(RegressionCNN(*SPACE)) == 90_934


def test_features_and_head_make_the_forward_pass(model: SuccessModel, view: ViewBatch, theta: Tensor) -> None:
    torch.testing.assert_close(model.head(model.features(view), theta), model(view, theta))


def test_calibration_moves_and_divides_every_logit(
    model: SuccessModel, view: ViewBatch, theta: Tensor
) -> None:
    raw, features = model(view, theta), model.features(view)
    assert torch.equal(raw, model.raw_head(features, theta))
    model.calibrate(logit_shift=0.5, temperature=2.0)
    for calibrated in (model(view, theta), model.head(features, theta)):
        torch.testing.assert_close(calibrated, (raw + 0.5) / 2.0)
    assert {"logit_shift", "temperature"} <= set(model.state_dict())


def test_grasps_may_share_one_view(model: SuccessModel, view: ViewBatch, theta: Tensor) -> None:
    shared = model.head(model.features(first(view)), theta)
    repeated = ViewBatch(*(part.expand(2, *part.shape[1:]) for part in first(view)))
    torch.testing.assert_close(shared, model(repeated, theta), rtol=1e-4, atol=1e-5)


def test_a_logit_does_not_depend_on_its_batch(model: SuccessModel, view: ViewBatch, theta: Tensor) -> None:
    torch.testing.assert_close(model(view, theta)[:1], model(first(view), theta[:1]), rtol=1e-4, atol=1e-5)


def test_gradient_by_theta_agrees_with_finite_differences(
    model: SuccessModel, view: ViewBatch, theta: Tensor
) -> None:
    model, theta = model.double(), theta[:1].double().requires_grad_()
    with torch.no_grad():
        features = model.features(first(view).to(theta))
    (gradient,) = torch.autograd.grad(model.head(features, theta).sum(), theta)
    # the last parameter turns the straight thumb about its own axis, which moves no fingertip
    assert (gradient[:, :-1] != 0).all()
    direction = torch.nn.functional.normalize(torch.randn_like(theta), dim=1)
    step = 1e-8 * direction
    with torch.no_grad():
        difference = model.head(features, theta + step) - model.head(features, theta - step)
    assert difference.item() / 2e-8 == pytest.approx((gradient * direction).sum().item(), rel=1e-3)


def test_dropout_works_in_training_only(model: SuccessModel, view: ViewBatch, theta: Tensor) -> None:
    assert torch.equal(model(view, theta), model(view, theta))
    model.train()
    drops = any(isinstance(layer, torch.nn.Dropout) for layer in model.modules())
    assert torch.equal(model(view, theta), model(view, theta)) is not drops


def test_half_precision_patches_are_taken(model: SuccessModel, view: ViewBatch, theta: Tensor) -> None:
    halves = view._replace(patch=view.patch.half())
    torch.testing.assert_close(model(halves, theta), model(view, theta), rtol=0.02, atol=0.02)


def test_the_networks_of_the_hand_see_where_it_is() -> None:
    """A mark in the image matters where the hand is, and nowhere else."""
    torch.manual_seed(0)
    model = PatchesCNN(*SPACE, projection=HandProjection(HAND)).eval()
    theta = torch.zeros(1, 14)
    theta[0, :3] = torch.tensor([-0.25, -0.25, 1.0])
    marks = []
    for row, column in ((75, 75), (350, 350)):
        patch = torch.zeros(1, 8, 400, 400)
        patch[:, :, row - 5 : row + 5, column - 5 : column + 5] = 1.0
        marks.append(model(view_of(patch, [[500.0, 500.0, 200.0, 200.0]]), theta))
    blank = model(view_of(torch.zeros(1, 8, 400, 400), [[500.0, 500.0, 200.0, 200.0]]), theta)
    assert not torch.equal(marks[0], blank)
    assert torch.equal(marks[1], blank)


def test_regression_learns_a_known_grasp() -> None:
    torch.manual_seed(0)
    model = RegressionCNN(*SPACE, keep_prob=1.0, ridge=0.0)
    view = view_of(torch.randn(2, 8, 400, 400), [[1.0] * 4] * 2)
    lifted = torch.randn(2, 14)
    model.fit_statistics(view.patch, lifted)
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-2)
    losses = []
    for _ in range(25):
        optimizer.zero_grad()
        loss = model.loss(model(view), lifted)
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert losses[-1] < 0.1 * losses[0]


def test_ridge_regression_weighs_the_output_layer() -> None:
    torch.manual_seed(0)
    model = RegressionCNN(*SPACE, ridge=0.5).eval()
    lifted = torch.zeros(2, 14)
    expected = 0.5 * model.output.weight.square().sum()
    torch.testing.assert_close(model.loss(lifted, lifted), expected)


def test_palm_points_depends_on_the_object_relative_to_the_palm_alone(view: ViewBatch, theta: Tensor) -> None:
    """Turning object, table and hand together about the camera changes nothing."""
    torch.manual_seed(0)
    model = PalmPoints(*SPACE).double().eval()
    view, theta = view.to(theta.double()), theta.double()
    turn = Rotation.from_euler("xyz", (0.3, -0.5, 0.8))
    matrix = torch.from_numpy(turn.as_matrix())
    turned = theta.clone()
    turned[:, :3] = theta[:, :3] @ matrix.T
    turned[:, 3:6] = torch.from_numpy((turn * Rotation.from_euler("xyz", theta[:, 3:6])).as_euler("xyz"))
    table = torch.cat((view.table[:, :3] @ matrix.T, view.table[:, 3:]), dim=1)
    seen = view._replace(points=view.points @ matrix.T, table=table)
    torch.testing.assert_close(model(seen, turned), model(view, theta))
    assert not torch.allclose(model(view, turned), model(view, theta))


def test_palm_points_sees_other_points_in_every_batch_of_a_training(view: ViewBatch, theta: Tensor) -> None:
    torch.manual_seed(0)
    model = PalmPoints(*SPACE, keep_prob=1.0)
    assert not torch.equal(model.train()(view, theta), model(view, theta))
    assert torch.equal(model.eval()(view, theta), model(view, theta))


def test_members_learn_by_themselves_and_their_probabilities_are_averaged(
    view: ViewBatch, theta: Tensor
) -> None:
    torch.manual_seed(0)
    model = PalmPoints(*SPACE, members=3).eval()
    logits = model.member_logits(view, theta)
    torch.testing.assert_close(torch.sigmoid(model(view, theta)), torch.sigmoid(logits).mean(dim=0))
    binary_cross_entropy_with_logits(logits[1], torch.ones(2)).backward()
    gradients = [parameter.grad for parameter in model.parameters() if parameter.grad is not None]
    assert len(gradients) == len(list(model.parameters()))
    for gradient in gradients:
        assert not gradient[[0, 2]].any()
    assert any(gradient[1].any() for gradient in gradients)
    assert not torch.allclose(logits[0], logits[1])


@pytest.mark.parametrize("logit", [-200.0, -3.0, 0.0, 40.0, 200.0])
def test_the_mean_of_equal_probabilities_is_theirs_however_sure_they_are(logit: float) -> None:
    logits = torch.full((5, 1), logit, requires_grad=True)
    mean = logit_of_mean(logits)
    torch.testing.assert_close(mean, torch.tensor([logit]))
    mean.sum().backward()
    torch.testing.assert_close(logits.grad, torch.full((5, 1), 0.2))
