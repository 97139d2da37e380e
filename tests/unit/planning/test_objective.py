import numpy as np
import pytest
import torch
from synthetic_views import view_of

from preshape.models.config_cnn import ConfigCNN
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import SuccessObjective, UnknownSuccess


@pytest.fixture(scope="module")
def network() -> ConfigCNN:
    torch.manual_seed(0)
    return ConfigCNN("config_cnn", "test", 14).double()


@pytest.fixture(scope="module")
def view() -> ViewBatch:
    patch = torch.rand(1, 8, 400, 400, generator=torch.Generator().manual_seed(1))
    return view_of(patch, [[525.0, 525.0, 200.0, 200.0]])


def some_theta(starts: int) -> torch.Tensor:
    return torch.randn(starts, 14, generator=torch.Generator().manual_seed(2), dtype=torch.float64)


def test_gradient_agrees_with_finite_differences(network: ConfigCNN, view: ViewBatch) -> None:
    objective = SuccessObjective(network, view)
    theta = some_theta(3).requires_grad_()
    (gradient,) = torch.autograd.grad(objective(theta).sum(), theta)
    epsilon = 1e-6
    for parameter in range(14):
        offset = torch.zeros(14, dtype=torch.float64)
        offset[parameter] = epsilon
        difference = (objective(theta + offset) - objective(theta - offset)) / (2 * epsilon)
        np.testing.assert_allclose(gradient[:, parameter], difference.detach(), rtol=1e-5, atol=1e-8)


def test_features_once_say_the_same_as_the_whole_network(network: ConfigCNN, view: ViewBatch) -> None:
    theta = some_theta(3)
    objective = SuccessObjective(network, view)
    logits = network(ViewBatch(*(part.double().expand(3, *part.shape[1:]) for part in view)), theta)
    np.testing.assert_allclose(objective.success_prob(theta).detach(), logits.sigmoid().detach(), rtol=1e-9)
    np.testing.assert_allclose(objective(theta).detach(), logits.sigmoid().log().detach(), rtol=1e-9)


def test_planning_leaves_the_network_as_it_was(network: ConfigCNN, view: ViewBatch) -> None:
    before = {name: value.clone() for name, value in network.state_dict().items()}
    initial = some_theta(2).numpy()
    planner = GradientAscent(LineSearch(first_step=0.25), max_iterations=3)
    planner.plan(SuccessObjective(network, view), initial, Bounds(initial - 0.1, initial + 0.1))
    assert all(torch.equal(before[name], value) for name, value in network.state_dict().items())
    assert all(weights.grad is None and weights.requires_grad for weights in network.parameters())


def test_a_single_precision_network_keeps_bounds_of_double_precision(view: ViewBatch) -> None:
    torch.manual_seed(3)
    objective = SuccessObjective(ConfigCNN("config_cnn", "test", 14), view)
    initial = some_theta(4).numpy()
    bounds = Bounds(initial - 1e-3 / 3, initial + 1e-3 / 3)
    result = GradientAscent(LineSearch(first_step=1.0)).plan(objective, initial, bounds)
    assert (result.theta >= bounds.lower).all()
    assert (result.theta <= bounds.upper).all()
    assert (result.log_posterior >= result.initial_log_posterior).all()
    assert result.theta.dtype == np.float64


def test_nothing_known_is_nan() -> None:
    assert UnknownSuccess().success_prob(some_theta(2)).isnan().all()
