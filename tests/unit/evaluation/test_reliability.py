"""Reliability diagrams count what they show; temperature scaling finds a temperature that is known."""

import numpy as np
import pytest
import torch
from scipy.special import expit, logit
from torchmetrics.functional.classification import binary_calibration_error

from preshape.data.batches import PositiveBatches
from preshape.evaluation.calibration import (
    MAX_TEMPERATURE,
    fit_temperature,
    oversampling_shift,
    reliability_diagram,
)


def draw(n: int, temperature: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Labels, and the logits of a network that is surer than it should be by a temperature."""
    rng = np.random.default_rng(0)
    logits = rng.normal(scale=1.5, size=n)
    return rng.uniform(size=n) < expit(logits), temperature * logits


def test_bins_hold_all_trials_and_their_rates() -> None:
    labels, logits = draw(400)
    probability = expit(logits)
    diagram = reliability_diagram(labels, probability, bins=5)
    assert diagram.count.sum() == 400
    second = (probability >= 0.2) & (probability < 0.4)
    assert diagram.count[1] == second.sum()
    assert diagram.predicted[1] == pytest.approx(probability[second].mean())
    assert diagram.observed[1] == pytest.approx(labels[second].mean())
    assert (diagram.low <= diagram.observed).all()
    assert (diagram.observed <= diagram.high).all()
    assert set(diagram.to_dict()) == {"count", "predicted", "observed", "low", "high"}


def test_expected_error_is_that_of_torchmetrics() -> None:
    labels, logits = draw(300, temperature=2.5)
    probability = expit(logits)
    reference = binary_calibration_error(
        torch.as_tensor(probability), torch.as_tensor(labels).int(), n_bins=10, norm="l1"
    )
    assert reliability_diagram(labels, probability).expected_error == pytest.approx(
        float(reference), abs=1e-6
    )


def test_certain_predictions_and_empty_bins_count() -> None:
    diagram = reliability_diagram(np.array([False, True, True]), np.array([0.0, 1.0, 1.0]))
    assert diagram.count.tolist() == [1, *[0] * 8, 2]
    assert np.isnan(diagram.observed[1:-1]).all()
    assert diagram.expected_error == 0.0


@pytest.mark.parametrize("temperature", [0.5, 1.0, 3.0])
def test_the_temperature_by_which_logits_are_too_sure_is_found(temperature: float) -> None:
    labels, logits = draw(20_000, temperature)
    assert fit_temperature(labels, logits) == pytest.approx(temperature, rel=0.05)


def test_separable_trials_have_a_bounded_temperature() -> None:
    labels = np.array([False, True])
    assert fit_temperature(labels, np.array([-1.0, 1.0])) == pytest.approx(1 / MAX_TEMPERATURE, rel=0.01)
    assert fit_temperature(labels, np.array([1.0, -1.0])) == pytest.approx(MAX_TEMPERATURE, rel=0.01)


@pytest.mark.parametrize("min_positives", [0, 1, 3])
def test_oversampling_is_undone_by_the_share_that_batches_really_have(min_positives: int) -> None:
    labels = np.arange(400) % 10 == 0
    batches = PositiveBatches(labels, batch_size=8, min_positives=min_positives, batches=4000, seed=0)
    drawn = np.mean([labels[batch].mean() for batch in batches])
    shift = oversampling_shift(400, 40, batch_size=8, min_positives=min_positives)
    assert shift == pytest.approx(logit(0.1) - logit(drawn), abs=0.03)
    assert oversampling_shift(400, 400, batch_size=8, min_positives=min_positives) == 0.0
