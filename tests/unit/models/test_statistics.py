"""Statistics of the training data, which travel with a network."""

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
