"""From an RGB-D view to ranked grasps."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import torch

from preshape.errors import InputError
from preshape.geometry.pose import pose_over_plane
from preshape.grasps.heuristic import HeuristicSettings, InitialGrasp, heuristic_grasps
from preshape.grasps.space import GraspSpace
from preshape.models.success_model import GraspNetwork, SuccessModel
from preshape.perception.object_view import object_cloud, object_patch
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, SegmentedObject, segment
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds, BoxSize
from preshape.planning.constraint import ConstrainedObjective
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.hand_clearance import HandClearance
from preshape.planning.objective import Objective, SuccessObjective, UnknownSuccess
from preshape.planning.planner import Planner
from preshape.planning.prior_choice import PriorChoice
from preshape.planning.regression import RegressedGrasp


@dataclass(frozen=True, eq=False)
class ViewPlanner:
    """Plans grasps for the object in a view: segmentation, heuristic grasps, objective, planner.

    Args:
        name: name of the planner, for plans and tables.
        method: the planner.
        box: how far it may go from an initial grasp.
        space: what theta means.
        heuristic, segmentation: how initial grasps are made.
        model: a trained network that predicts success; None if nothing is known about it.
        constraint: where the hand may not be; None for anywhere.
        prior: what counts beside the success of a grasp.
        proposer: says one grasp instead of the heuristic ones, if given.
    """

    name: str
    method: Planner
    box: BoxSize
    space: GraspSpace
    heuristic: HeuristicSettings
    model: GraspNetwork | None = None
    constraint: HandClearance | None = None
    prior: PriorChoice = field(default_factory=PriorChoice)
    proposer: RegressedGrasp | None = None
    segmentation: SegmentationSettings = field(default_factory=SegmentationSettings)

    def plan(self, observation: Observation, rng: np.random.Generator) -> GraspPlan:
        """Plan from heuristic initial grasps.

        Raises:
            InputError: if no object can be made out on a table.
        """
        segmented = segment(observation, self.segmentation)
        initial = heuristic_grasps(segmented, self.space, self.heuristic, observation.camera, rng)
        return self.plan_from(observation, segmented, initial)

    def plan_from(
        self, observation: Observation, segmented: SegmentedObject, initial: Sequence[InitialGrasp]
    ) -> GraspPlan:
        """Plan from initial grasps that are there already, so that planners can be compared."""
        theta = np.stack([grasp.theta for grasp in initial])
        # As in the paper (section 4.3), and because the network has seen no other preshapes.
        space = self.space.narrowed(self.heuristic.joint_ranges)
        bounds = Bounds.around(theta, space, self.box)
        view = self._view(observation, segmented)
        if self.proposer is not None:
            said = self.proposer.grasp(view)
            nearest = int(np.linalg.norm(theta[:, :3] - said[:3], axis=1).argmin())
            theta, bounds, initial = said[None], bounds[np.array([nearest])], [initial[nearest]]
        box = segmented.T_camera_box
        objective = self.prior.joined_to(self._likelihood(view), self.space, view, box)
        if self.constraint is not None:
            objective = ConstrainedObjective(objective, self.constraint.in_view(segmented))
        result = self.method.plan(objective, theta, bounds)
        faces = tuple(grasp.face for grasp in initial)
        poses = observation.camera.T_world_camera, pose_over_plane(segmented.plane)
        return GraspPlan(self.name, self.space, faces, result, *poses)

    def _view(self, observation: Observation, segmented: SegmentedObject) -> ViewBatch:
        # The patch takes longer than all else of a view, so it is made only for networks that look at it.
        judged_by_patch = self.model is not None and "patch" in self.model.looks_at
        cloud = object_cloud(segmented)
        if self.proposer is None and not judged_by_patch:
            return ViewBatch.of([cloud], [observation.camera])
        patch = object_patch(observation, cloud.centre(observation.camera))
        return ViewBatch.of([cloud], [observation.camera], torch.from_numpy(patch)[None])

    def _likelihood(self, view: ViewBatch) -> Objective:
        if self.model is None:
            return UnknownSuccess()
        if not isinstance(self.model, SuccessModel):
            raise InputError(
                f"The network `{self.model.name}` does not predict the success of grasps",
                where="model",
                fix="choose one that does, such as model=config_cnn",
            )
        return SuccessObjective(self.model, view)
