"""Planned grasps keep what is demanded of them."""

from dataclasses import dataclass

import numpy as np
import pytest
import torch
from analytic_objectives import linear, quadratic

from preshape.planning.bounds import Bounds
from preshape.planning.constraint import Barrier, ConstrainedObjective, Slack
from preshape.planning.cross_entropy import CrossEntropyPlanner
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.lbfgs import LbfgsPlanner
from preshape.planning.line_search import LineSearch
from preshape.planning.max_eval import MaxEvalPlanner
from preshape.planning.multi_start import MultiStart
from preshape.planning.planner import Planner
from preshape.planning.random_search import RandomSearchPlanner
from preshape.planning.result import PlanStatus
from preshape.planning.sampling import SamplingPlanner

ASCENT = GradientAscent(LineSearch(first_step=0.25, growth=2.0, max_step=1.0), tolerance=1e-6, patience=5)
PLANNERS = {
    "inference": ASCENT,
    "paper": GradientAscent(LineSearch(first_step=0.001), climbed="logit", step_unit="raw"),
    "several starts": MultiStart(ASCENT, samples=20, climbed=2, seed=0),
    "lbfgs": LbfgsPlanner(max_iterations=50, tolerance=1e-6),
    "cem": CrossEntropyPlanner(5, 30, 0.2, 0.8, 0.5, seed=0),
    "random search": RandomSearchPlanner(80, 0.5, 0.02, seed=0),
    "sampling": SamplingPlanner(150, seed=0),
    "max-eval": MaxEvalPlanner(),
}
EVERY_PLANNER = pytest.mark.parametrize("planner", PLANNERS.values(), ids=PLANNERS)


@dataclass(frozen=True)
class OutsideDisc:
    """Keep out of a disc, and under a line."""

    radius: float = 0.3
    highest: float = 0.9

    def slack(self, theta: np.ndarray) -> Slack:
        distance = np.linalg.norm(theta[:, :2], axis=1)
        values = np.stack((distance - self.radius, self.highest - theta[:, 1]), axis=1)

        def pull_back(weights: np.ndarray) -> np.ndarray:
            outwards = theta / distance[:, None]
            return weights[:, :1] * outwards + weights[:, 1:] * np.array([0.0, -1.0])

        return Slack(values, pull_back)


BARRIER = Barrier(margin_m=0.05, relaxed_m=0.01)


def box(starts: int) -> Bounds:
    return Bounds(np.full((starts, 2), -1.0), np.full((starts, 2), 1.0))


@EVERY_PLANNER
def test_a_plan_from_allowed_grasps_is_allowed_and_never_worse(planner: Planner) -> None:
    rng = np.random.default_rng(0)
    initial = rng.uniform(-1, 0.85, (12, 2))
    initial = initial[np.linalg.norm(initial, axis=1) > 0.3]
    objective = ConstrainedObjective(quadratic(np.zeros(2), np.full(2, 9.0)), OutsideDisc(), BARRIER)
    result = planner.plan(objective, initial, box(len(initial)))
    assert (result.violation_m == 0).all()
    assert (OutsideDisc().slack(result.theta).values >= 0).all()
    assert (result.log_posterior >= result.initial_log_posterior).all()
    assert all((np.diff(probs) >= 0).all() for probs in result.climb)
    for start, (path, probs) in enumerate(zip(result.path, result.climb, strict=True)):
        np.testing.assert_array_equal(path[[0, -1]], [result.initial_theta[start], result.theta[start]])
        said = objective.success_prob(torch.from_numpy(path)).numpy()
        np.testing.assert_allclose(said, probs, rtol=1e-12)


def test_the_ascent_slides_along_what_is_not_allowed() -> None:
    """From the left of the disc to a corner on its right, under the line."""
    objective = ConstrainedObjective(linear(np.array([4.0, 1.0])), OutsideDisc(), BARRIER)
    result = ASCENT.plan(objective, np.array([[-0.9, 0.05]]), box(1))
    assert result.theta[0, 0] == 1.0
    assert 0.85 < result.theta[0, 1] <= 0.9


@EVERY_PLANNER
def test_what_is_not_allowed_comes_last_and_is_named(planner: Planner) -> None:
    """The third start is caught in the disc, though the objective likes it best."""
    initial = np.array([[0.5, 0.0], [0.9, 0.0], [0.0, 0.1]])
    bounds = Bounds(initial - 0.1, initial + 0.1)
    objective = ConstrainedObjective(quadratic(np.zeros(2), np.ones(2)), OutsideDisc(), BARRIER)
    result = planner.plan(objective, initial, bounds)
    assert result.ranking[-1] == 2
    assert result.status[2] == PlanStatus.INFEASIBLE
    assert 0 < result.violation_m[2] <= 0.2 + 1e-9
    assert result.violation_m[:2].max() == 0


@pytest.mark.parametrize("planner", [PLANNERS["inference"], PLANNERS["cem"], PLANNERS["lbfgs"]])
def test_a_start_that_is_not_allowed_is_left_for_one_that_is(planner: Planner) -> None:
    objective = ConstrainedObjective(quadratic(np.zeros(2), np.full(2, 0.5)), OutsideDisc(), BARRIER)
    result = planner.plan(objective, np.array([[0.05, 0.25]]), box(1))
    assert result.violation_m[0] == 0
    assert np.linalg.norm(result.theta[0]) < 0.5


def test_the_barrier_has_the_gradient_that_it_says() -> None:
    theta = torch.tensor([[0.31, 0.0], [0.2, 0.1], [0.0, 0.88], [0.7, 0.7]], dtype=torch.float64)
    objective = ConstrainedObjective(linear(np.zeros(2)), OutsideDisc(), BARRIER)
    assert torch.autograd.gradcheck(
        lambda theta: objective.evaluate(theta).log_barrier, theta.requires_grad_()
    )
    far, near = objective.evaluate(theta).log_barrier[3], objective.evaluate(theta).log_barrier[:3]
    assert far == 0
    assert (near < 0).all()
