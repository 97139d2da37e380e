"""Planning with image features computed once per view, against the whole network at every step."""

import numpy as np
import torch
from comparison import Comparison, side_by_side
from torch import Tensor

from preshape.models.config_cnn import ConfigCNN
from preshape.perception.object_view import PATCH_SIZE
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch
from preshape.planning.objective import Evaluation, Objective, SuccessObjective
from preshape.planning.result import PlanResult

STARTS, ITERATIONS, RUNS = 3, 100, 3


class WholeNetwork(Objective):
    """The same objective, with the image channel run again at every evaluation, in all threads."""

    def __init__(self, model: ConfigCNN, view: ViewBatch) -> None:
        self._model, self._view = model.eval(), view
        self._threads = torch.get_num_threads()

    def evaluate(self, theta: Tensor) -> Evaluation:
        planning_threads = torch.get_num_threads()
        torch.set_num_threads(self._threads)
        views = ViewBatch(*(part.expand(len(theta), *part.shape[1:]) for part in self._view))
        logit = self._model(views, theta.float()).double()
        torch.set_num_threads(planning_threads)
        return Evaluation.of(logit)


def features_once(seed: int, flop_per_s: float) -> Comparison:
    """One plan from three initial grasps, image features included; the network need not be trained."""
    generator = torch.Generator().manual_seed(seed)
    torch.manual_seed(seed)
    model = ConfigCNN("config_cnn", "benchmark", 14)
    view = ViewBatch(torch.rand(1, 8, PATCH_SIZE, PATCH_SIZE, generator=generator), torch.ones(1, 4))
    initial = torch.randn(STARTS, 14, generator=generator, dtype=torch.float64).numpy()
    bounds = Bounds(initial - 1.0, initial + 1.0)
    planner = GradientAscent(LineSearch(first_step=0.001), step_unit="raw", max_iterations=ITERATIONS)

    def plan(objective: type[SuccessObjective] | type[WholeNetwork]) -> PlanResult:
        return planner.plan(objective(model, view), initial, bounds)

    ours, peer = plan(SuccessObjective), plan(WholeNetwork)
    if not np.allclose(ours.log_posterior, peer.log_posterior, atol=1e-4):
        raise AssertionError("the two ways of planning do not end at the same objective")
    return side_by_side(
        f"plan from {STARTS} initial grasps, {ITERATIONS} iterations, image features computed once",
        lambda: plan(SuccessObjective),
        "whole network for each grasp at every step",
        lambda: plan(WholeNetwork),
        RUNS,
        flop_per_s,
    )
