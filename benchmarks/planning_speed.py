"""Planning by inference against the paper's algorithm taken literally, and against SciPy's L-BFGS-B."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import torch
from comparison import Comparison, side_by_side
from noise_views import noise_views
from torch import Tensor

from preshape.models.config_cnn import ConfigCNN
from preshape.models.palm_points import PalmPoints
from preshape.models.success_model import SuccessModel
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.lbfgs import LbfgsPlanner
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import Evaluation, Objective, SuccessObjective
from preshape.planning.result import PlanResult

ITERATIONS, RUNS = 100, 3
STARTS = (3, 32, 256)
HALF_WIDTH = np.array([0.05] * 3 + [0.157] * 3 + [0.25] * 8)
"""Of the paper's box around an initial grasp (m and rad)."""


class WholeNetwork(Objective):
    """The same objective, with the image channel run again at every evaluation, in all threads."""

    def __init__(self, model: SuccessModel, view: ViewBatch) -> None:
        self._model, self._view = model.eval(), view
        self._threads = torch.get_num_threads()

    def evaluate(self, theta: Tensor) -> Evaluation:
        planning_threads = torch.get_num_threads()
        torch.set_num_threads(self._threads)
        views = ViewBatch(*(part.expand(len(theta), *part.shape[1:]) for part in self._view))
        logit = self._model(views, theta.float()).double()
        torch.set_num_threads(planning_threads)
        return Evaluation.of(logit)


INFERENCE = GradientAscent(LineSearch(first_step=0.25, growth=2.0, max_step=1.0))
"""As `planner=inference`, but that it does not stop before its last iteration as long as it climbs."""
PAPER = GradientAscent(LineSearch(first_step=0.001), climbed="logit", step_unit="raw")
LBFGS = LbfgsPlanner(max_iterations=ITERATIONS, tolerance=1e-9)


Plan = Callable[[], list[PlanResult]]
Compare = Callable[[int, float], Comparison]


def planning_comparisons() -> list[Compare]:
    """Plans with image features included; the networks need not be trained."""
    torch.manual_seed(0)
    config_cnn = ConfigCNN("config_cnn", "benchmark", 14)
    palm_points = PalmPoints("palm_points", "benchmark", 14)
    against_scipy = [
        partial(_scipy, model, starts) for model in (config_cnn, palm_points) for starts in STARTS
    ]
    return [partial(_literal, config_cnn), *against_scipy]


def _literal(model: SuccessModel, seed: int, flop_per_s: float) -> Comparison:
    """The whole network at every step, one initial grasp at a time, with the paper's steps."""
    view, initial, bounds = _problem(STARTS[0], seed)

    def literally() -> list[PlanResult]:
        planner, rows = replace(PAPER, max_iterations=ITERATIONS), np.arange(len(initial))[:, None]
        return [planner.plan(WholeNetwork(model, view), initial[row], bounds[row]) for row in rows]

    return _compare(
        f"{model.name}: plan from {len(initial)} initial grasps, {ITERATIONS} iterations",
        _planned(INFERENCE, model, view, initial, bounds),
        "the paper's steps with the whole network, one initial grasp at a time",
        literally,
        len(initial),
        flop_per_s,
    )


def _scipy(model: SuccessModel, starts: int, seed: int, flop_per_s: float) -> Comparison:
    view, initial, bounds = _problem(starts, seed)
    return _compare(
        f"{model.name}: plan from {starts} initial grasps, at most {ITERATIONS} iterations",
        _planned(INFERENCE, model, view, initial, bounds),
        "SciPy's L-BFGS-B from one after the other",
        _planned(LBFGS, model, view, initial, bounds),
        starts,
        flop_per_s,
    )


def _planned(
    planner: GradientAscent | LbfgsPlanner,
    model: SuccessModel,
    view: ViewBatch,
    initial: np.ndarray,
    bounds: Bounds,
) -> Plan:
    planner = replace(planner, max_iterations=ITERATIONS)
    return lambda: [planner.plan(SuccessObjective(model, view), initial, bounds)]


def _compare(name: str, ours: Plan, peer_name: str, peer: Plan, starts: int, flop_per_s: float) -> Comparison:
    """Time both, and say how many evaluations they took and what they found."""
    details: dict[str, float] = {}

    def noted(who: str, plan: Plan) -> None:
        results = plan()
        details[f"{who}_evaluations"] = sum(result.evaluations for result in results)
        found = np.concatenate([result.log_posterior for result in results])
        details[f"{who}_log_prob"] = float(found.mean())

    runs = RUNS if starts < STARTS[-1] else 1
    timed = side_by_side(
        name, lambda: noted("ours", ours), peer_name, lambda: noted("peer", peer), runs, flop_per_s
    )
    return replace(timed, details=details)


def _problem(starts: int, seed: int) -> tuple[ViewBatch, np.ndarray, Bounds]:
    """A view of noise, and initial grasps a metre before the camera."""
    generator = torch.Generator().manual_seed(seed)
    view = noise_views(1, generator)
    initial = 0.3 * torch.randn(starts, 14, generator=generator, dtype=torch.float64).numpy()
    initial[:, :3] = 0.2 * initial[:, :3] + [0.0, 0.0, 1.0]
    return view, initial, Bounds(initial - HALF_WIDTH, initial + HALF_WIDTH)
