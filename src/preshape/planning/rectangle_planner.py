"""From an RGB-D view to a ranked grasp of a two-finger gripper (paper, section 4.4)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float, Float64

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.object_finder import FinderSettings, centre_of, find_object
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_views import RectangleViewSettings, rectangle_batch, rectangle_view
from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.geometry.pose import pose_over_plane
from preshape.grasps.heuristic import InitialGrasp
from preshape.grasps.rectangle_pose import RectanglePoseSettings, jaw_pose
from preshape.grasps.rectangle_space import JAW_PX, rectangle_of
from preshape.grasps.space import GraspSpace
from preshape.models.success_model import SuccessModel
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentedObject
from preshape.perception.table import TableSettings, find_table
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds, RectangleBox
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.objective import Objective, SuccessObjective, UnknownSuccess
from preshape.planning.planner import Planner
from preshape.planning.result import PlanResult


@dataclass(frozen=True)
class RectangleStarts:
    """Initial rectangles: at the centre of the object, in random directions.

    Args:
        count: how many; the paper has 4.
        opening_px: their opening; the paper has 30.
    """

    count: int = 4
    opening_px: float = 30.0

    def around(self, centre: tuple[float, float], rng: np.random.Generator) -> Float64[np.ndarray, "s 4"]:
        """Theta of each; a smaller count gives the first ones of a larger.

        Args:
            centre: of the object (u, v in pixels).
            rng: source of the directions.
        """
        angles = rng.uniform(0, math.pi, self.count)
        return np.array([(*centre, angle, self.opening_px) for angle in angles])


@dataclass(frozen=True, eq=False)
class RectanglePlan:
    """What a planner found in one view, in the image alone.

    Args:
        planner: name of the planner.
        result: the rectangles as theta = (u, v, angle, opening); its angle may be any.
        jaw_px: width of the jaws.
    """

    planner: str
    result: PlanResult
    jaw_px: float

    @property
    def best(self) -> GraspRectangle:
        """The rectangle to try first."""
        return self.rectangle(self.result.best)

    def rectangle(self, start: int) -> GraspRectangle:
        """The rectangle planned from a start."""
        return rectangle_of(self.result.theta[start], self.jaw_px)

    def initial(self, start: int) -> GraspRectangle:
        """The rectangle of a start before planning."""
        return rectangle_of(self.result.initial_theta[start], self.jaw_px)


@dataclass(frozen=True, eq=False)
class RectanglePlanner:
    """Plans rectangles for the object in a view, from initial ones at its centre.

    Args:
        name: name of the planner.
        method: the planner.
        box: how far it may go from an initial rectangle.
        space: what theta means.
        starts: the initial rectangles.
        views: how the network wants to see images.
        finder: how the object is found.
        model: a trained network that judges rectangles; None if nothing is known about them.
        jaw_px: width of the jaws.
        pose: how the gripper is put at a rectangle.
    """

    name: str
    method: Planner
    box: RectangleBox
    space: GraspSpace
    starts: RectangleStarts
    views: RectangleViewSettings
    finder: FinderSettings
    model: SuccessModel | None = None
    jaw_px: float = JAW_PX
    pose: RectanglePoseSettings = field(default_factory=RectanglePoseSettings)

    def with_model(self, model: SuccessModel, method: Planner | None = None) -> "RectanglePlanner":
        """The same planner with a trained network, and perhaps another method."""
        return replace(self, model=model, method=method or self.method)

    def plan(self, observation: Observation, rng: np.random.Generator) -> GraspPlan:
        """Plan from initial rectangles at the centre of the object.

        Raises:
            InputError: if the image has another size than the grasp space, or no object can be made out.
        """
        size = observation.depth.shape
        if size != (HEIGHT, WIDTH):
            raise InputError(
                f"The image has {size[1]} x {size[0]} pixels",
                where="view",
                fix=f"crop or scale it to {WIDTH} x {HEIGHT}, and its camera file, too",
            )
        initial = self.starts.around(centre_of(find_object(observation, self.finder)), rng)
        points = observation.camera.unproject(observation.depth.astype(np.float64))
        up = observation.camera.T_world_camera[2, :3]
        return self._plan_on(observation, find_table(points, up, TableSettings()).plane, initial)

    def plan_from(
        self, observation: Observation, segmented: SegmentedObject, initial: Sequence[InitialGrasp]
    ) -> GraspPlan:
        """Plan from initial rectangles that are there already, so that planners can be compared."""
        return self._plan_on(observation, segmented.plane, np.stack([grasp.theta for grasp in initial]))

    def _plan_on(
        self, observation: Observation, table: Float[np.ndarray, "4"], initial: Float64[np.ndarray, "s 4"]
    ) -> GraspPlan:
        view = rectangle_batch([rectangle_view(observation, self.views)])
        plan = self.plan_in(view, initial)
        jaws = tuple(
            jaw_pose(plan.rectangle(start), observation, table, self.pose) for start in range(len(initial))
        )
        faces = (Face.TOP,) * len(initial)
        poses = observation.camera.T_world_camera, pose_over_plane(table)
        return GraspPlan(self.name, self.space, faces, plan.result, *poses, jaws)

    def plan_in(self, view: ViewBatch, initial: Float64[np.ndarray, "s 4"]) -> RectanglePlan:
        """Plan in a view that has been made before."""
        objective: Objective = UnknownSuccess() if self.model is None else SuccessObjective(self.model, view)
        bounds = Bounds.around(initial, self.space, self.box)
        return RectanglePlan(self.name, self.method.plan(objective, initial, bounds), self.jaw_px)
