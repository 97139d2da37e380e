"""config-CNN: size, split into features and head, gradients."""

import math

import pytest
import torch
from torch import Tensor

from preshape.models.config_cnn import ConfigCNN
from preshape.models.success_model import MIN_THETA_STD


@pytest.fixture
def model() -> ConfigCNN:
    torch.manual_seed(0)
    return ConfigCNN("config_cnn", "allegro_palm14", 14).eval()


@pytest.fixture
def patch() -> Tensor:
    return torch.randn(3, 8, 400, 400, generator=torch.Generator().manual_seed(1))


@pytest.fixture
def theta() -> Tensor:
    return torch.randn(3, 14, generator=torch.Generator().manual_seed(2))


def test_has_the_papers_number_of_parameters(model: ConfigCNN) -> None:
    assert sum(parameter.numel() for parameter in model.parameters()) == 61_065


def test_features_and_head_make_the_forward_pass(model: ConfigCNN, patch: Tensor, theta: Tensor) -> None:
    torch.testing.assert_close(model.head(model.features(patch), theta), model(patch, theta))


def test_grasps_may_share_the_features_of_one_view(model: ConfigCNN, patch: Tensor, theta: Tensor) -> None:
    shared = model.head(model.features(patch[:1]), theta)
    torch.testing.assert_close(shared, model(patch[:1].expand(3, -1, -1, -1), theta))


def test_a_logit_does_not_depend_on_its_batch(model: ConfigCNN, patch: Tensor, theta: Tensor) -> None:
    one_by_one = torch.cat([model(patch[i : i + 1], theta[i : i + 1]) for i in range(3)])
    torch.testing.assert_close(model(patch, theta), one_by_one, rtol=1e-4, atol=1e-5)


def test_gradient_by_theta_agrees_with_finite_differences(
    model: ConfigCNN, patch: Tensor, theta: Tensor
) -> None:
    model = model.double()
    features = model.features(patch[:1].double()).detach()
    assert torch.autograd.gradcheck(
        lambda theta: model.head(features, theta), theta.double().requires_grad_(), eps=1e-7, atol=1e-6
    )


def test_dropout_works_in_training_only(model: ConfigCNN, patch: Tensor, theta: Tensor) -> None:
    assert torch.equal(model(patch, theta), model(patch, theta))
    model.train()
    assert not torch.equal(model(patch, theta), model(patch, theta))


def test_statistics_normalise_the_training_data(model: ConfigCNN, patch: Tensor, theta: Tensor) -> None:
    scaled = 5.0 * patch + 2.0
    model.fit_statistics(scaled, theta)
    normalized = model.normalize_patch(scaled).transpose(0, 1).flatten(1)
    torch.testing.assert_close(normalized.mean(dim=1), torch.zeros(8), atol=1e-4, rtol=0)
    torch.testing.assert_close(normalized.std(dim=1), torch.ones(8), atol=1e-4, rtol=0)


def test_statistics_survive_missing_values_and_constant_parameters(
    model: ConfigCNN, patch: Tensor, theta: Tensor
) -> None:
    patch, theta = patch.clone(), theta.clone()
    patch[:, 3, :100] = math.nan
    patch[:, 7] = 0.0
    theta[:, 12] = 1.4
    theta[0, 0] = math.nan
    model.fit_statistics(patch, theta)
    assert model.image_mean.isfinite().all()
    assert model.image_std.min() > 0
    assert model.theta_std[12].item() == pytest.approx(MIN_THETA_STD)
    assert model.theta_mean[0].item() == pytest.approx(theta[1:, 0].mean().item(), abs=1e-6)
