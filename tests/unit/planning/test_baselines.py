import numpy as np
import pytest
from analytic_objectives import quadratic

from preshape.planning.bounds import Bounds
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.max_eval import MaxEvalPlanner
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


@pytest.mark.parametrize("samples", [1, 7])
def test_sampling_never_returns_worse_than_the_initial_grasp(samples: int) -> None:
    best = np.zeros((1, 2))
    bounds = Bounds(np.full((1, 2), -1.0), np.ones((1, 2)))
    np.testing.assert_array_equal(SamplingPlanner(samples, seed=0).plan(OBJECTIVE, best, bounds).theta, best)
