"""From a grasp rectangle in a view to the pose of a two-finger gripper, and back.

As in the paper (section 4.5) and in Lenz, Lee and Saxena (IJRR 2015): the gripper aims at the point of the
surface under the rectangle's centre, comes against the surface's normal there, and turns and opens as the
rectangle does.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from preshape.cornell.rectangle import GraspRectangle
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import make_pose
from preshape.perception.observation import Observation

MIN_NEIGHBOURS = 12
"""A normal is fitted to at least so many points."""
SAME_DEPTH_PX = 2
"""Pixels so near to the centre tell its depth together, because one pixel is noisy."""


@dataclass(frozen=True)
class RectanglePoseSettings:
    """How a gripper is put at a rectangle.

    Args:
        insertion_m: how far the fingers' ends go beyond the surface point.
        table_clearance_m: least height of the fingers' ends over the table; they go less far for it.
        max_tilt_rad: largest angle between the approach and the vertical. A normal that leans more is turned
            back to it: at edges and on steep sides it mixes surfaces or is noise, and a gripper that comes
            low has its own arm in the table.
        finger_m: what a finger takes up beyond the opening, along it.
        jaw_m: width of the jaws, across the opening.
        normal_radius_px: pixels around the centre to which the surface's plane is fitted.
        same_surface_m: neighbours whose depth differs by more belong to another surface.
    """

    insertion_m: float = 0.03
    table_clearance_m: float = 0.004
    max_tilt_rad: float = 0.52
    finger_m: float = 0.015
    jaw_m: float = 0.042
    normal_radius_px: int = 8
    same_surface_m: float = 0.02


@dataclass(frozen=True, eq=False)
class JawPose:
    """Where a gripper is.

    Args:
        T_camera_jaws: the point between the fingers' ends; x along the approach, y along the opening.
        opening_m: how far the jaws are apart.
        advance_m: how far this point is beyond the surface point, along the approach.
    """

    T_camera_jaws: Float[np.ndarray, "4 4"]
    opening_m: float
    advance_m: float

    @property
    def surface_point(self) -> Float[np.ndarray, "3"]:
        """The point of the surface that the gripper aims at (m, camera frame)."""
        point: Float[np.ndarray, "3"] = self.T_camera_jaws[:3, 3] - self.advance_m * self.T_camera_jaws[:3, 0]
        return point


def jaw_pose(
    rectangle: GraspRectangle,
    observation: Observation,
    table: Float[np.ndarray, "4"],
    settings: RectanglePoseSettings,
) -> JawPose:
    """The pose of a gripper that grasps as a rectangle says.

    The rectangle's opening is measured in the plane through the surface point across the approach, to first
    order, so that `rectangle_of` gives the same rectangle back. Its jaw width is not used: that is the
    gripper's own.

    Args:
        rectangle: in the view's pixels.
        observation: the view.
        table: plane (a, b, c, d) of the table in the camera frame, with n . p + d the height of p over it.
        settings: how far and how steeply the gripper goes.

    Raises:
        InputError: if the view has no depth at all.
    """
    point, normal = surface_at(observation, rectangle.u, rectangle.v, settings)
    approach = _within_cone(-table[:3] if normal is None else -normal, -table[:3], settings.max_tilt_rad)
    along, opening_m = _opening_axis(rectangle, point, approach, observation.camera)
    rotation = np.stack((approach, along, np.cross(approach, along)), axis=1)
    reach = opening_m / 2 + settings.finger_m
    advance = _advance(point, rotation, reach, table, settings)
    return JawPose(make_pose(rotation, point + advance * approach), opening_m, advance)


def rectangle_of(pose: JawPose, camera: Camera, jaw_px: float) -> GraspRectangle:
    """The rectangle whose `jaw_pose` this is: the jaws projected to the image at their surface point.

    Args:
        pose: the gripper's.
        camera: of the view.
        jaw_px: width of the jaws that the rectangle is given.
    """
    point = pose.surface_point
    u, v = camera.project(point)
    shift = _jacobian(point, camera) @ pose.T_camera_jaws[:3, 1] * pose.opening_m
    angle = float(np.arctan2(shift[1], shift[0]))
    return GraspRectangle(float(u), float(v), angle, float(np.hypot(*shift)), jaw_px)


def surface_at(
    observation: Observation, u: float, v: float, settings: RectanglePoseSettings
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"] | None]:
    """The surface's point in a pixel and its unit normal towards the camera (m, camera frame).

    Where there is no depth, the nearest pixel that has some lends its depth. The normal is None where too few
    neighbours lie on the same surface.

    Raises:
        InputError: if the view has no depth at all.
    """
    camera, depth = observation.camera, observation.depth
    known = np.isfinite(depth)
    if not known.any():
        raise InputError(
            "The view has no depth", where="depth image", fix="check the sensor and the depth's unit"
        )
    near = known & _disc(depth.shape, u, v, SAME_DEPTH_PX)
    if near.any():
        z = float(np.median(depth[near]))
    else:
        rows, columns = np.nonzero(known)
        z = float(depth[known][np.argmin((columns - u) ** 2 + (rows - v) ** 2)])
    point = z * np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    around = known & _disc(depth.shape, u, v, settings.normal_radius_px)
    around[around] = np.abs(depth[around] - z) < settings.same_surface_m
    return point, _normal(_points(depth, around, camera))


def _disc(shape: tuple[int, ...], u: float, v: float, radius: int) -> Bool[np.ndarray, "h w"]:
    rows, columns = np.ogrid[: shape[0], : shape[1]]
    inside: Bool[np.ndarray, "h w"] = (columns - u) ** 2 + (rows - v) ** 2 <= radius**2
    return inside


def _points(
    depth: Float[np.ndarray, "h w"], pixels: Bool[np.ndarray, "h w"], camera: Camera
) -> Float[np.ndarray, "n 3"]:
    rows, columns = np.nonzero(pixels)
    z = depth[pixels].astype(np.float64)
    return np.stack(((columns - camera.cx) / camera.fx * z, (rows - camera.cy) / camera.fy * z, z), axis=1)


def _normal(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3"] | None:
    """Unit normal towards the camera of the plane through points; None for too few."""
    if len(points) < MIN_NEIGHBOURS:
        return None
    centre = points.mean(axis=0)
    normal: Float[np.ndarray, "3"] = np.linalg.eigh(np.cov((points - centre).T))[1][:, 0]
    return normal if normal @ centre < 0 else -normal


def _within_cone(
    direction: Float[np.ndarray, "3"], axis: Float[np.ndarray, "3"], max_angle_rad: float
) -> Float[np.ndarray, "3"]:
    """The unit vector nearest to a direction that is within an angle of an axis."""
    cosine = float(np.clip(direction @ axis, -1.0, 1.0))
    if cosine >= np.cos(max_angle_rad):
        return direction
    aside = direction - cosine * axis
    length = float(np.linalg.norm(aside))
    if length < 1e-6:  # straight away from the axis, so no side is nearer than another
        return axis
    turned: Float[np.ndarray, "3"] = np.cos(max_angle_rad) * axis + np.sin(max_angle_rad) * aside / length
    return turned


def _jacobian(point: Float[np.ndarray, "3"], camera: Camera) -> Float[np.ndarray, "2 3"]:
    """How a point's pixel (u, v) moves with the point (px / m)."""
    x, y, z = point
    return np.array(
        [[camera.fx / z, 0.0, -camera.fx * x / z**2], [0.0, camera.fy / z, -camera.fy * y / z**2]]
    )


def _opening_axis(
    rectangle: GraspRectangle,
    point: Float[np.ndarray, "3"],
    approach: Float[np.ndarray, "3"],
    camera: Camera,
) -> tuple[Float[np.ndarray, "3"], float]:
    """Unit vector along the opening, across the approach, and the opening (m)."""
    # two pixel coordinates, and the demand that the axis is across the approach
    equations = np.vstack((_jacobian(point, camera), camera.fx * approach))
    one_pixel = [np.cos(rectangle.angle_rad), np.sin(rectangle.angle_rad), 0.0]
    axis = np.linalg.solve(equations, np.array(one_pixel))
    metres_per_pixel = float(np.linalg.norm(axis))
    return axis / metres_per_pixel, metres_per_pixel * rectangle.opening_px


def _advance(
    point: Float[np.ndarray, "3"],
    rotation: Float[np.ndarray, "3 3"],
    reach_m: float,
    table: Float[np.ndarray, "4"],
    settings: RectanglePoseSettings,
) -> float:
    """How far the fingers' ends go beyond the surface point with their lowest corner clear of the table."""
    approach, along, across = table[:3] @ rotation
    corner = abs(along) * reach_m + abs(across) * settings.jaw_m / 2
    spare = float(table[:3] @ point + table[3]) - corner - settings.table_clearance_m
    return float(min(settings.insertion_m, spare / -approach))
