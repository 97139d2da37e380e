"""Heuristic initial grasps: one for each visible face of the object's bounding box (paper, section 4.1)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from preshape.data.trial import Face
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace
from preshape.perception.segmentation import SegmentedObject


@dataclass(frozen=True, eq=False)
class InitialGrasp:
    """Where planning starts.

    Args:
        theta: grasp configuration, palm in the camera frame (m, rad).
        face: the face of the bounding box that it aims at.
    """

    theta: Float[np.ndarray, "d"]
    face: Face


@dataclass(frozen=True)
class HeuristicSettings:
    """How initial grasps are made from a bounding box.

    Args:
        joint_ranges: (low, high) in rad from which each preshape joint is drawn; equal numbers fix the joint.
        top_offset_m, side_offset_m: distance of the palm's origin from the face's centre along its normal.
        offset_noise_m: standard deviation of the noise on that distance.
        axis_noise_rad: standard deviation of the noise on the turn of a top grasp about the vertical.
        min_top_palm_height_m, min_side_palm_height_m: lowest height of the palm's origin over the table for
            top and for side grasps, so that the hand clears the table; a lower palm is raised to it.
        min_side_height_m: lower objects get a top grasp only.
        reach_direction: world direction in which the arm reaches; the fingers of a top grasp point that way.
    """

    joint_ranges: Mapping[str, Sequence[float]]
    top_offset_m: float = 0.02
    side_offset_m: float = 0.03
    offset_noise_m: float = 0.001
    axis_noise_rad: float = 0.05
    min_top_palm_height_m: float = 0.02
    min_side_palm_height_m: float = 0.02
    min_side_height_m: float = 0.03
    reach_direction: Sequence[float] = (1.0, 0.0, 0.0)


def heuristic_grasps(
    segmented: SegmentedObject,
    space: GraspSpace,
    settings: HeuristicSettings,
    camera: Camera,
    rng: np.random.Generator,
) -> list[InitialGrasp]:
    """Initial grasps at the top face and, if the object is tall enough, at the two side faces in view.

    The palm's x axis looks against the face's outward normal. Side grasps have the thumb (y) up; top grasps
    have the fingers (z) along the face's major or minor axis, at random, pointing away from the robot.

    Args:
        segmented: the object.
        space: grasp space of theta; preshape joints are clipped to its limits.
        settings: distances and ranges.
        camera: camera of the view, for the direction away from the robot and the nearer faces.
        rng: source of every random number; the same generator state gives the same grasps.

    Returns:
        Grasps at the top, then at the nearer and at the farther one of the two side faces that look towards
        the camera.

    Raises:
        InputError: a preshape joint of the grasp space has no range.
    """
    top = _top_rotation(segmented, settings, camera, rng)
    faces = {Face.TOP: (top, settings.top_offset_m, settings.min_top_palm_height_m)}
    if segmented.extents[2] >= settings.min_side_height_m:
        for face, normal in zip((Face.SIDE_NEAREST, Face.SIDE_SECOND), visible_sides(segmented), strict=True):
            side = _side_rotation(segmented, normal)
            faces[face] = (side, settings.side_offset_m, settings.min_side_palm_height_m)
    grasps = []
    for face, (rotation, offset, min_height) in faces.items():
        distance = rng.normal(offset, settings.offset_noise_m)
        palm = _palm_position(segmented, -rotation[:, 0], distance, min_height)
        joints = _preshape(space, settings.joint_ranges, rng)
        grasps.append(InitialGrasp(space.theta(make_pose(rotation, palm), joints), face))
    return grasps


def visible_sides(segmented: SegmentedObject) -> list[Float[np.ndarray, "3"]]:
    """Outward unit normals (camera frame) of the two side faces nearer to the camera, the nearest first.

    Of each pair of opposite faces the nearer one counts: the far side of a thin box is closer than its ends,
    but it is hidden.
    """
    centre = segmented.T_camera_box[:3, 3]
    sides = []
    for axis in (0, 1):
        normal = segmented.T_camera_box[:3, axis]
        normal = normal if normal @ centre <= 0 else -normal
        sides.append((np.linalg.norm(centre + normal * segmented.extents[axis] / 2), axis, normal))
    return [normal for _, _, normal in sorted(sides, key=lambda side: side[:2])]


def _side_rotation(segmented: SegmentedObject, normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Palm facing a side face, thumb up."""
    up = segmented.T_camera_box[:3, 2]
    return np.stack((-normal, up, np.cross(-normal, up)), axis=1)


def _top_rotation(
    segmented: SegmentedObject, settings: HeuristicSettings, camera: Camera, rng: np.random.Generator
) -> Float[np.ndarray, "3 3"]:
    """Palm facing down, fingers along a random horizontal axis of the box and away from the robot."""
    down = -segmented.T_camera_box[:3, 2]
    fingers = segmented.T_camera_box[:3, rng.integers(2)]
    reach = camera.T_world_camera[:3, :3].T @ np.asarray(settings.reach_direction)
    fingers = fingers if fingers @ reach >= 0 else -fingers
    turn = rng.normal(0.0, settings.axis_noise_rad)
    fingers = np.cos(turn) * fingers + np.sin(turn) * np.cross(down, fingers)
    return np.stack((down, np.cross(fingers, down), fingers), axis=1)


def _palm_position(
    segmented: SegmentedObject, normal: Float[np.ndarray, "3"], distance: float, min_height_m: float
) -> Float[np.ndarray, "3"]:
    """Point at a distance from the centre of the face with the given normal, raised if too near the table."""
    box = segmented.T_camera_box
    to_face = np.abs(box[:3, :3].T @ normal) @ segmented.extents / 2
    palm = box[:3, 3] + (to_face + distance) * normal
    height = palm @ segmented.plane[:3] + segmented.plane[3]
    raised: Float[np.ndarray, "3"] = palm + max(0.0, min_height_m - height) * segmented.plane[:3]
    return raised


def _preshape(
    space: GraspSpace, ranges: Mapping[str, Sequence[float]], rng: np.random.Generator
) -> Float[np.ndarray, "j"]:
    """Preshape joints drawn from their ranges, within the limits of the grasp space."""
    missing = [name for name in space.joint_names if name not in ranges]
    if missing:
        raise InputError(
            f"No range to draw the preshape joints {', '.join(missing)} from",
            where="joint_ranges of the heuristic grasps",
            fix=f"give a range for each joint of the grasp space {space.name!r}",
        )
    low, high = np.array([tuple(ranges[name]) for name in space.joint_names]).T
    joints: Float[np.ndarray, "j"] = np.clip(rng.uniform(low, high), space.lower[6:], space.upper[6:])
    return joints
