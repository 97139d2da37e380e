"""Where the hand may not be: in the table, in the object, and in either of them before it approaches."""

from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float64
from torch import Tensor

from preshape.hands.volume import HandVolume
from preshape.perception.segmentation import SegmentedObject
from preshape.planning.object_solid import ObjectSolid, SolidSettings
from preshape.planning.objective import Evaluation, Objective


@runtime_checkable
class Constraint(Protocol):
    """What is demanded of a grasp."""

    def slack(self, theta: Float64[Tensor, "s d"]) -> Float64[Tensor, "s k"]:
        """By how much (m) s grasps meet k demands, negative where they do not; differentiable."""
        ...


@dataclass(frozen=True, eq=False)
class HandClearance:
    """Demands that keep the hand free of table and object, in the preshape and before the approach.

    The hand comes straight along the palm's normal, as in the simulator and the paper. That it is free at the
    beginning and at the end of this line keeps it free of the table all along it.

    Args:
        hand: the space that the hand takes up. What is attached to it is kept off the table only.
        table_m: least distance of the hand from the table.
        object_depth_m: how deep the hand may be in the object; closing starts there, and depth is noisy.
        pregrasp_m: least distance of the hand from the object where the approach begins.
        approach_m: length of the approach.
        solid: how the object is made solid from one view.
    """

    hand: HandVolume
    table_m: float
    object_depth_m: float
    pregrasp_m: float
    approach_m: float
    solid: SolidSettings = field(default_factory=SolidSettings)

    def in_view(self, segmented: SegmentedObject) -> "ViewClearance":
        """The demands around the object of a view."""
        return ViewClearance(self, segmented)


class ViewClearance:
    """See `HandClearance`, which makes it."""

    def __init__(self, demands: HandClearance, segmented: SegmentedObject) -> None:
        self._demands = demands
        self._solid = ObjectSolid(segmented, demands.solid)
        self._plane = torch.from_numpy(segmented.plane).double()

    def slack(self, theta: Float64[Tensor, "s d"]) -> Float64[Tensor, "s k"]:
        """For each sphere: over the table; for the hand's own: out of the object, and before the approach."""
        demands, up = self._demands, self._plane[:3]
        volume = demands.hand
        spheres, radii = volume.centres(theta), volume.radii
        back = -demands.approach_m * volume.kinematics.palm_link_pose(theta)[:, None, :3, 0]
        lowest = spheres @ up + self._plane[3] + (back @ up).clamp_max(0.0) - radii
        hand, radii = spheres[:, volume.attached :], radii[volume.attached :]
        distance = self._solid.distance(torch.cat((hand, hand + back), dim=1))
        here, before = (distance - radii.repeat(2)).chunk(2, dim=1)
        return torch.cat(
            (lowest - demands.table_m, here + demands.object_depth_m, before - demands.pregrasp_m), dim=1
        )


@dataclass(frozen=True)
class Barrier:
    """A relaxed logarithmic barrier before each demand.

    It rises from 0 at `margin_m` of slack like a logarithm, so that climbers slide along what is not allowed
    instead of ending there, and goes on as a parabola where a demand is nearly or not met.

    Args:
        weight: of the barrier against the log posterior.
        margin_m: slack from which on it is 0.
        relaxed_m: slack below which it is a parabola.
    """

    weight: float = 0.1
    margin_m: float = 0.006
    relaxed_m: float = 0.001

    def __call__(self, slack: Float64[Tensor, "s k"]) -> Float64[Tensor, "s"]:
        """Log barrier of s grasps, at most 0."""
        ratio = slack.clamp(self.relaxed_m, self.margin_m) / self.margin_m
        beyond = (slack - self.relaxed_m).clamp_max(0.0)
        slope = 1 / self.margin_m - 1 / self.relaxed_m
        cost = ratio - 1 - ratio.log() + slope * beyond + (beyond / self.relaxed_m).square() / 2
        return -self.weight * cost.sum(dim=1)


class ConstrainedObjective(Objective):
    """An objective of which not every grasp is allowed.

    Args:
        objective: what says how good a grasp is.
        constraint: what says whether it is allowed.
        barrier: what keeps climbers away from those that are not.
    """

    def __init__(self, objective: Objective, constraint: Constraint, barrier: Barrier = Barrier()) -> None:
        self._objective, self._constraint, self._barrier = objective, constraint, barrier

    def evaluate(self, theta: Float64[Tensor, "s d"]) -> Evaluation:
        slack = self._constraint.slack(theta)
        violation = (-slack.detach()).amax(dim=1).clamp_min(0.0)
        evaluation = self._objective.evaluate(theta)
        return replace(evaluation, violation=violation, log_barrier=self._barrier(slack))
