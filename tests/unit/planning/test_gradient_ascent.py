from dataclasses import replace

import numpy as np
import pytest
import torch
from analytic_objectives import AnalyticObjective, linear, quadratic, rosenbrock
from hypothesis import given, settings
from hypothesis import strategies as st

from preshape.planning.bounds import Bounds
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import Objective
from preshape.planning.result import PlanResult, PlanStatus

INFERENCE = GradientAscent(
    LineSearch(first_step=0.25, growth=2.0, max_step=1.0), tolerance=1e-12, max_iterations=300
)
PAPER = GradientAscent(LineSearch(first_step=0.001), climbed="logit", step_unit="raw", max_iterations=100)
PLANNERS = pytest.mark.parametrize("planner", [INFERENCE, PAPER], ids=["inference", "paper"])


def box(lower: list[float], upper: list[float], starts: int = 1) -> Bounds:
    return Bounds(np.array([lower] * starts, dtype=float), np.array([upper] * starts, dtype=float))


def plan(planner: GradientAscent, objective: Objective, start: list[float], bounds: Bounds) -> PlanResult:
    return planner.plan(objective, np.array([start]), bounds)


def test_finds_the_optimum_inside_the_box() -> None:
    objective = quadratic(np.array([0.3, -0.2, 0.5]), np.array([1.0, 30.0, 3.0]))
    result = plan(INFERENCE, objective, [-0.9, 0.9, 0.0], box([-1] * 3, [1] * 3))
    np.testing.assert_allclose(result.theta[0], [0.3, -0.2, 0.5], atol=1e-5)
    assert result.status == (PlanStatus.CONVERGED,)


def test_finds_the_optimum_on_active_bounds() -> None:
    objective = quadratic(np.array([2.0, 0.1, -5.0]), np.array([1.0, 5.0, 0.2]))
    result = plan(INFERENCE, objective, [-0.9, 0.9, 0.0], box([-1] * 3, [1] * 3))
    np.testing.assert_allclose(result.theta[0], [1.0, 0.1, -1.0], atol=1e-5)
    assert result.theta[0, 0] == 1.0
    assert result.theta[0, 2] == -1.0
    assert result.status == (PlanStatus.AT_BOUNDS,)


@pytest.mark.parametrize(("right", "optimum"), [(2.0, [1.0, 1.0]), (0.5, [0.5, 0.25])])
def test_follows_a_curved_ridge_to_its_top_or_to_the_bounds(right: float, optimum: list[float]) -> None:
    result = plan(INFERENCE, rosenbrock(steepness=10), [-1.2, 1.0], box([-2, -2], [right, 2]))
    np.testing.assert_allclose(result.theta[0], optimum, atol=0.05)


def test_parameters_of_any_unit_converge_alike() -> None:
    """Metres beside millimetres: scaling a parameter and its box changes nothing."""
    scale = np.array([1.0, 1e-3, 1e3])
    plain = plan(
        INFERENCE, quadratic(np.full(3, 0.2), np.array([1.0, 2.0, 3.0])), [0.0] * 3, box([-1] * 3, [1] * 3)
    )
    scaled_objective = quadratic(0.2 * scale, np.array([1.0, 2.0, 3.0]) / scale**2)
    scaled = plan(INFERENCE, scaled_objective, [0.0] * 3, box((-scale).tolist(), scale.tolist()))
    np.testing.assert_allclose(scaled.theta / scale, plain.theta, rtol=1e-6)


def test_the_papers_first_step_is_a_thousandth_of_the_gradient_of_the_logit() -> None:
    slope = np.array([3.0, -2.0])
    result = plan(replace(PAPER, max_iterations=1), linear(slope), [0.1, 0.2], box([-1, -1], [1, 1]))
    np.testing.assert_allclose(result.theta[0], [0.1 + 0.003, 0.2 - 0.002], rtol=1e-12)


def test_the_papers_step_restarts_in_every_iteration() -> None:
    result = plan(PAPER, linear(np.array([3.0])), [0.0], box([-1], [1]))
    assert result.theta[0, 0] == pytest.approx(100 * 0.001 * 3)
    assert result.evaluations == 101
    assert result.status == (PlanStatus.ITERATION_LIMIT,)


def test_a_step_that_overshoots_is_halved() -> None:
    """From 0.999 the first step leads past the maximum at 1 to 1.002, half of it to 1.0005."""
    objective = AnalyticObjective(lambda theta: -1500 * (theta[:, 0] - 1).square())
    result = plan(replace(PAPER, max_iterations=1), objective, [0.999], box([-9], [9]))
    assert result.theta[0, 0] == pytest.approx(1.0005)
    assert result.evaluations == 3


def test_armijo_demands_more_than_any_increase() -> None:
    def first_step(sufficient_increase: float) -> float:
        search = LineSearch(first_step=0.9, sufficient_increase=sufficient_increase)
        planner = GradientAscent(search, climbed="logit", step_unit="raw", max_iterations=1)
        objective = AnalyticObjective(lambda theta: -theta[:, 0].square())
        return float(plan(planner, objective, [1.0], box([-9], [9])).theta[0, 0])

    assert first_step(0.0) == pytest.approx(-0.8)
    assert first_step(0.5) == pytest.approx(1 - 0.45 * 2)


def test_a_linear_objective_ends_in_the_corner() -> None:
    result = plan(INFERENCE, linear(np.array([1.0, -2.0, 0.5])), [0.0] * 3, box([-1] * 3, [1, 2, 3]))
    np.testing.assert_array_equal(result.theta[0], [1.0, -1.0, 3.0])
    assert result.status == (PlanStatus.AT_BOUNDS,)


def test_a_flat_objective_has_converged_before_it_starts() -> None:
    result = plan(INFERENCE, linear(np.zeros(2)), [0.5, 0.5], box([0, 0], [1, 1]))
    assert result.status == (PlanStatus.CONVERGED,)
    assert result.iterations.tolist() == [0]


def test_a_fixed_parameter_that_is_pushed_does_not_count_as_at_bounds() -> None:
    objective = AnalyticObjective(lambda theta: theta[:, 0] - theta[:, 1].square())
    result = plan(INFERENCE, objective, [0.5, 0.8], box([0.5, -1], [0.5, 1]))
    assert result.status == (PlanStatus.CONVERGED,)
    assert result.theta[0, 0] == 0.5


def test_a_gradient_that_leads_nowhere_is_reported() -> None:
    """The gradient of x - x.detach() - x^2 at 0 is 1, yet no other point is higher."""
    objective = AnalyticObjective(lambda theta: (theta - theta.detach() - theta.detach().square())[:, 0])
    result = plan(INFERENCE, objective, [0.0], box([-1], [1]))
    assert result.status == (PlanStatus.NO_ASCENT,)
    assert result.theta[0, 0] == 0.0


def test_a_network_that_says_nan_is_not_climbed() -> None:
    objective = AnalyticObjective(lambda theta: theta[:, 0] * torch.nan)
    result = plan(INFERENCE, objective, [0.25], box([-1], [1]))
    assert result.status == (PlanStatus.NO_ASCENT,)
    assert result.theta[0, 0] == 0.25


def test_a_start_outside_its_box_is_projected_first() -> None:
    result = plan(INFERENCE, linear(np.zeros(1)), [7.0], box([-1], [1]))
    assert result.initial_theta[0, 0] == 1.0


def test_a_prior_pulls_the_optimum_towards_its_mode() -> None:
    likelihood = quadratic(np.array([0.8]), np.array([3.0]))
    posterior = AnalyticObjective(
        lambda theta: likelihood.evaluate(theta).logit, lambda theta: -1e6 * (theta[:, 0] + 0.5).square()
    )
    result = plan(INFERENCE, posterior, [0.0], box([-1], [1]))
    assert result.theta[0, 0] == pytest.approx(-0.5, abs=1e-4)


def wavy(seed: int, dim: int) -> AnalyticObjective:
    """A smooth objective with many hills."""
    generator = torch.Generator().manual_seed(seed)
    frequency = 6 * torch.randn(dim, 5, generator=generator, dtype=torch.float64)
    phase = 6 * torch.rand(5, generator=generator, dtype=torch.float64)
    return AnalyticObjective(lambda theta: 3 * torch.sin(theta @ frequency + phase).sum(dim=1))


@PLANNERS
@given(seed=st.integers(0, 10_000), starts=st.integers(1, 5))
@settings(max_examples=8, deadline=None)
def test_result_is_inside_never_worse_and_monotone(planner: GradientAscent, seed: int, starts: int) -> None:
    rng = np.random.default_rng(seed)
    centre, half_width = rng.normal(size=(starts, 4)), rng.uniform(0, 1, (starts, 4)) ** 3
    bounds = Bounds(centre - half_width, centre + half_width)
    result = replace(planner, max_iterations=10).plan(wavy(seed, 4), centre, bounds)
    assert (result.theta >= bounds.lower).all()
    assert (result.theta <= bounds.upper).all()
    assert (result.log_posterior >= result.initial_log_posterior).all()
    assert all((np.diff(probs) >= 0).all() for probs in result.climb)
    assert [len(probs) - 1 for probs in result.climb] == result.iterations.tolist()
    assert result.log_posterior[result.best] == result.log_posterior.max()
    np.testing.assert_allclose(
        wavy(seed, 4).success_prob(torch.from_numpy(result.theta)).numpy(), result.success_prob, rtol=1e-9
    )


@PLANNERS
@given(seed=st.integers(0, 10_000))
@settings(max_examples=4, deadline=None)
def test_a_batch_gives_what_its_starts_give_one_by_one(planner: GradientAscent, seed: int) -> None:
    initial = np.random.default_rng(seed).uniform(-1, 1, (4, 3))
    bounds = box([-1] * 3, [1] * 3, starts=4)
    planner = replace(planner, max_iterations=8)
    together = planner.plan(wavy(seed, 3), initial, bounds)
    alone = [planner.plan(wavy(seed, 3), initial[[i]], bounds[np.array([i])]) for i in range(4)]
    np.testing.assert_allclose(together.theta, np.concatenate([result.theta for result in alone]), rtol=1e-6)
    assert together.status == tuple(result.status[0] for result in alone)
    assert together.evaluations == sum(result.evaluations for result in alone)
