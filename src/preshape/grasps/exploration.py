"""Heuristic grasps with the palm moved and tilted, for a network to see more than the heuristic does."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from preshape.geometry.camera import Camera
from preshape.geometry.pose import make_pose
from preshape.grasps.heuristic import HeuristicSettings, InitialGrasp, heuristic_grasps
from preshape.grasps.space import GraspSpace
from preshape.perception.segmentation import SegmentedObject


@dataclass(frozen=True)
class ExplorationSettings:
    """How far grasps stray from the heuristic ones.

    Planning climbs away from the heuristic grasps; a network that learned from them alone would have to guess
    there, because they put the palm within a millimetre of the same place.

    Args:
        grasps_per_face: explored grasps per face; 0 for none.
        position_m: standard deviation of the palm's shift along each axis.
        rotation_rad: standard deviation of the palm's turn about each of its axes.
    """

    grasps_per_face: int = 0
    position_m: float = 0.02
    rotation_rad: float = 0.1


def explored_grasps(
    segmented: SegmentedObject,
    space: GraspSpace,
    heuristic: HeuristicSettings,
    exploration: ExplorationSettings,
    camera: Camera,
    rng: np.random.Generator,
) -> list[InitialGrasp]:
    """New draws of the heuristic grasps, each with its palm moved and tilted at random.

    Args:
        segmented: the object.
        space: grasp space of theta.
        heuristic: distances and ranges of the heuristic grasps.
        exploration: how many, and how far they stray.
        camera: camera of the view.
        rng: source of every random number.

    Returns:
        For each round over the faces, grasps in the order of `heuristic_grasps`.

    Raises:
        InputError: a preshape joint of the grasp space has no range.
    """
    return [
        replace(grasp, theta=_strayed(grasp.theta, space, exploration, rng))
        for _ in range(exploration.grasps_per_face)
        for grasp in heuristic_grasps(segmented, space, heuristic, camera, rng)
    ]


def _strayed(
    theta: Float[np.ndarray, "d"], space: GraspSpace, settings: ExplorationSettings, rng: np.random.Generator
) -> Float[np.ndarray, "d"]:
    palm = space.palm_pose(theta)
    turn = Rotation.from_rotvec(rng.normal(0.0, settings.rotation_rad, size=3)).as_matrix()
    shift = rng.normal(0.0, settings.position_m, size=3)
    return space.theta(make_pose(palm[:3, :3] @ turn, palm[:3, 3] + shift), space.joints(theta))
