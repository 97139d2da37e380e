import numpy as np
import pytest
import torch
from analytic_objectives import AnalyticObjective, quadratic

from preshape.planning.bounds import Bounds
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.line_search import LineSearch
from preshape.planning.max_eval import MaxEvalPlanner
from preshape.planning.multi_start import MultiStart
from preshape.planning.objective import UnknownSuccess
from preshape.planning.result import PlanStatus
from preshape.planning.sampling import SamplingPlanner

INITIAL = np.array([[0.9, 0.9], [0.1, 0.0], [-0.4, 0.5]])
BOUNDS = Bounds(INITIAL - 0.2, INITIAL + 0.2)
OBJECTIVE = quadratic(np.zeros(2), np.ones(2))


def test_heuristic_keeps_the_order_and_reports_the_probabilities() -> None:
    result = HeuristicPlanner().plan(OBJECTIVE, INITIAL, BOUNDS)
    np.testing.assert_array_equal(result.theta, INITIAL)
    assert result.ranking.tolist() == [0, 1, 2]
    assert result.success_prob.argmax() == 1
    assert set(result.status) == {PlanStatus.NOT_OPTIMIZED}


def test_heuristic_works_without_a_network() -> None:
    result = HeuristicPlanner().plan(UnknownSuccess(), INITIAL, BOUNDS)
    assert np.isnan(result.success_prob).all()
    assert result.best == 0
    assert result.evaluations == 0


def test_max_eval_ranks_and_changes_nothing() -> None:
    result = MaxEvalPlanner().plan(OBJECTIVE, INITIAL, BOUNDS)
    np.testing.assert_array_equal(result.theta, INITIAL)
    assert result.ranking.tolist() == [1, 2, 0]
    assert result.evaluations == 3


def test_sampling_keeps_the_best_of_its_box_and_repeats_with_its_seed() -> None:
    planner = SamplingPlanner(samples_per_start=50, seed=3)
    result = planner.plan(OBJECTIVE, INITIAL, BOUNDS)
    assert (result.theta >= BOUNDS.lower).all()
    assert (result.theta <= BOUNDS.upper).all()
    assert (result.log_posterior >= result.initial_log_posterior).all()
    assert result.log_posterior[0] > result.initial_log_posterior[0]
    assert result.evaluations == 153
    np.testing.assert_array_equal(result.theta, planner.plan(OBJECTIVE, INITIAL, BOUNDS).theta)
    other = SamplingPlanner(samples_per_start=50, seed=4).plan(OBJECTIVE, INITIAL, BOUNDS)
    assert (other.theta != result.theta).any()


def test_several_starts_find_the_higher_of_two_summits() -> None:
    """From the initial grasp the ascent leads to the nearer, lower summit."""

    def two_summits(theta: torch.Tensor) -> torch.Tensor:
        low, high = ((theta - centre).square().sum(dim=1) for centre in (-0.5, 0.5))
        return torch.maximum(1 - 20 * low, 2 - 20 * high)

    objective = AnalyticObjective(two_summits)
    initial, bounds = np.full((2, 2), -0.6), Bounds(np.full((2, 2), -1.0), np.ones((2, 2)))
    ascent = GradientAscent(LineSearch(0.25, growth=2.0, max_step=1.0), tolerance=1e-6, patience=5)
    alone = ascent.plan(objective, initial, bounds)
    several = MultiStart(ascent, samples=30, climbed=2, seed=0).plan(objective, initial, bounds)
    np.testing.assert_allclose(alone.theta, -0.5, atol=1e-3)
    np.testing.assert_allclose(several.theta, 0.5, atol=1e-3)
    np.testing.assert_array_equal(several.initial_theta, initial)
    for start in range(2):
        np.testing.assert_array_equal(several.path[start][[0, -1]], [initial[start], several.theta[start]])
        assert len(several.path[start]) == len(several.climb[start]) == several.iterations[start] + 1
        assert several.climb[start][-1] == several.success_prob[start]
    assert several.evaluations > alone.evaluations + 60


@pytest.mark.parametrize("samples", [1, 7])
def test_sampling_never_returns_worse_than_the_initial_grasp(samples: int) -> None:
    best = np.zeros((1, 2))
    bounds = Bounds(np.full((1, 2), -1.0), np.ones((1, 2)))
    np.testing.assert_array_equal(SamplingPlanner(samples, seed=0).plan(OBJECTIVE, best, bounds).theta, best)
