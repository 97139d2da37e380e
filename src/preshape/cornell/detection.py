"""Detection: one rectangle for an image, by inference and by what it is compared with."""

import logging
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from preshape.cornell.data_set import CornellImage
from preshape.cornell.object_finder import centre_of, find_object
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_dataset import LoadedImage
from preshape.cornell.rectangle_metric import is_correct
from preshape.cornell.rectangle_views import rectangle_batch
from preshape.cornell.views import load_cornell_view
from preshape.errors import InputError
from preshape.models.success_model import SuccessModel
from preshape.perception.view_batch import ViewBatch
from preshape.planning.max_eval import MaxEvalPlanner
from preshape.planning.rectangle_planner import RectanglePlan, RectanglePlanner
from preshape.planning.result import rank_by

log = logging.getLogger(__name__)

AT_ONCE = 256
"""Rectangles of the exhaustive search that are judged together: patches take memory."""


@dataclass(frozen=True)
class RectangleGrid:
    """Rectangles all over an object.

    Args:
        reach_px: how far centres lie from the object's, in both directions.
        step_px: distance of neighbouring centres.
        angles: number of angles, evenly spaced over half a turn.
        openings_px: the openings.
    """

    reach_px: float
    step_px: float
    angles: int
    openings_px: Sequence[float]

    def around(self, centre: tuple[float, float]) -> Float64[np.ndarray, "n 4"]:
        """Theta of each rectangle around an object's centre (u, v in pixels)."""
        offsets = np.arange(-self.reach_px, self.reach_px + 1e-9, self.step_px)
        angles = np.arange(self.angles) * math.pi / self.angles
        axes = (centre[0] + offsets, centre[1] + offsets, angles, np.array(self.openings_px))
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)


@dataclass(frozen=True)
class Detection:
    """The rectangle that a method proposes for an image.

    Args:
        image: number of the image.
        method: `random`, `max_eval`, `inference` or `grid`.
        starts: from how many rectangles it was chosen, or planned.
        rectangle: the rectangle.
        success_prob: what the network says of it.
        correct: whether the rectangle metric accepts it.
    """

    image: int
    method: str
    starts: int
    rectangle: GraspRectangle
    success_prob: float
    correct: bool

    def to_dict(self) -> dict[str, Any]:
        """As it stands in result files."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Detector:
    """Proposes rectangles for images, by every method from the same initial rectangles.

    Args:
        planner: the planner, whose number of starts is the largest that is tried.
        counts: numbers of initial rectangles that are compared; each takes the first ones.
        grid: of the exhaustive search, which takes longest; None for none.
        seed: of the initial rectangles; those of an image are the same for every network.
    """

    planner: RectanglePlanner
    counts: Sequence[int]
    grid: RectangleGrid | None
    seed: int

    def __post_init__(self) -> None:
        if not all(count >= 1 for count in self.counts):
            where = f"detector.counts={list(self.counts)}"
            raise InputError("Something is chosen of no rectangle", where=where, fix="give counts from 1 on")

    def centre(self, image: CornellImage) -> tuple[float, float]:
        """Centre of an image's object, or of the image where none is found.

        Raises:
            InputError: if a file is missing or damaged.
        """
        observation = load_cornell_view(image.files).observation
        try:
            return centre_of(find_object(observation, self.planner.finder))
        except InputError as error:
            height, width = observation.depth.shape
            log.warning("Image %04d: %s; its middle is taken", image.files.number, error.what)
            return (width - 1) / 2, (height - 1) / 2

    def detect(
        self, loaded: LoadedImage, centre: tuple[float, float], model: SuccessModel
    ) -> list[Detection]:
        """What every method proposes for an image.

        Args:
            loaded: the image.
            centre: of its object.
            model: a trained network.
        """
        number = loaded.image.files.number
        initial = self.planner.starts.around(centre, np.random.default_rng([self.seed, number]))
        view = rectangle_batch([loaded.view])
        plan = self.planner.with_model(model).plan_in(view, initial)
        found = [self._chosen(loaded, plan, 1, "random")]
        for count in self.counts:
            found += [self._chosen(loaded, plan, count, method) for method in ("max_eval", "inference")]
        if self.grid is not None:
            found.append(self._exhaustive(self.grid, loaded, view, centre, model))
        return found

    def _chosen(self, loaded: LoadedImage, plan: RectanglePlan, count: int, method: str) -> Detection:
        """The best of the first starts, before planning or after."""
        result = plan.result
        if method == "inference":
            prob = result.success_prob[:count]
            best = int(rank_by(prob)[0])
            return _detection(loaded, method, count, plan.rectangle(best), prob[best])
        prob = result.initial_success_prob[:count]
        best = int(rank_by(prob)[0])
        return _detection(loaded, method, count, plan.initial(best), prob[best])

    def _exhaustive(
        self,
        grid: RectangleGrid,
        loaded: LoadedImage,
        view: ViewBatch,
        centre: tuple[float, float],
        model: SuccessModel,
    ) -> Detection:
        theta = grid.around(centre)
        low, high = self.planner.space.lower, self.planner.space.upper
        inside = theta[((theta >= low) & (theta <= high)).all(axis=1)]
        planner = self.planner.with_model(model, MaxEvalPlanner())
        plans = (
            planner.plan_in(view, inside[first : first + AT_ONCE]) for first in range(0, len(inside), AT_ONCE)
        )
        best = max(plans, key=lambda plan: float(plan.result.success_prob[plan.result.best]))
        prob = best.result.success_prob[best.result.best]
        return _detection(loaded, "grid", len(inside), best.best, prob)


def _detection(
    loaded: LoadedImage, method: str, starts: int, rectangle: GraspRectangle, success_prob: float
) -> Detection:
    correct = is_correct(rectangle, loaded.image.positives)
    return Detection(loaded.image.files.number, method, starts, rectangle, float(success_prob), correct)
