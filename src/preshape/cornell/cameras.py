"""The camera of the data set, whose calibration was not published: fitted to measured points, or nominal."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float64
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.text_files import damaged
from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, make_pose, transform_points

NOMINAL_FOCAL_PX = 525.0
NOMINAL_POSITION_M = (0.614, -0.193, 0.745)
NOMINAL_EULER_RAD = (-2.5073, 0.1001, -1.4418)
"""Pose of the optical frame in the frame of the robot's base, extrinsic XYZ.

With it and the focal length of a Kinect, range images of the table (pixelwise medians of 60 images) are those
of a plane to 0.5 mm, and the published points of pcd0100 lie on their pixels to 0.1 pixels.
"""
SAMPLED_POINTS, COARSE_POINTS = 1500, 60
MIN_POINTS = 100
FOCAL_WEIGHT = 1.0
GOOD_COST = 0.5 * COARSE_POINTS * 0.1**2
"""Half the sum of squares where the points miss by a tenth of a pixel: no other start does better."""
MAX_MEDIAN_PX = 2.0
FAR_OFF_PX = 5.0
MAX_FAR_OFF_SHARE = 0.01


def nominal_camera() -> Camera:
    """The camera where the measured points are missing; its world is the frame of the robot's base."""
    rotation = Rotation.from_euler("xyz", NOMINAL_EULER_RAD).as_matrix()
    return _camera(NOMINAL_FOCAL_PX, make_pose(rotation, np.array(NOMINAL_POSITION_M)))


def fit_camera(points: Float64[np.ndarray, "h w 3"], path: Path) -> tuple[Camera, Float64[np.ndarray, "h w"]]:
    """Focal length and pose of the camera that sees each point in its pixel, and the points' depth (m).

    The world is the frame that the points are in. Depth is NaN where there is no point, or one that belongs
    into another pixel.

    Args:
        points: of the pixels (m); NaN where unknown.
        path: the file that they are from, for messages.

    Raises:
        InputError: if there are too few points, or no such camera: the file's points or pixels are wrong.
    """
    v, u = np.nonzero(np.isfinite(points).all(axis=-1))
    if len(u) < MIN_POINTS:
        raise damaged(path, f"{len(u)} measured points are too few")
    chosen = np.linspace(0, len(u) - 1, min(len(u), SAMPLED_POINTS)).astype(int)
    pixels = np.stack((u[chosen], v[chosen]), axis=1).astype(np.float64)
    camera = _nearest_camera(pixels, points[v[chosen], u[chosen]])
    seen = transform_points(invert_pose(camera.T_world_camera), points[v, u])
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.hypot(*(np.stack(camera.project(seen)) - (u, v)))
    wrong = ~((off <= FAR_OFF_PX) & (seen[:, 2] > 0))
    if not np.median(off) <= MAX_MEDIAN_PX or wrong.mean() > MAX_FAR_OFF_SHARE:
        raise damaged(path, "no camera could see its points in the pixels that it names")
    depth = np.full(points.shape[:2], np.nan)
    depth[v[~wrong], u[~wrong]] = seen[~wrong, 2]
    return camera, depth


def _nearest_camera(pixels: Float[np.ndarray, "n 2"], points: Float64[np.ndarray, "n 3"]) -> Camera:
    """The camera with the smallest distance between pixels and projected points.

    It climbs from several starts with a few points, and from the best of them with all.
    """
    few = np.linspace(0, len(points) - 1, COARSE_POINTS).astype(int)
    best = None
    for start in _starts(pixels, points):
        fit = least_squares(
            _misses, start, _slopes, method="lm", args=(pixels[few], points[few]), x_scale="jac", max_nfev=30
        )
        best = fit if best is None or fit.cost < best.cost else best
        if best.cost < GOOD_COST:
            break
    assert best is not None
    start = best.x
    fit = least_squares(_misses, start, _slopes, args=(pixels, points), loss="soft_l1", x_scale="jac")
    T_camera_world = make_pose(Rotation.from_rotvec(fit.x[:3]).as_matrix(), fit.x[3:6])
    return _camera(_focal(fit.x), invert_pose(T_camera_world))


def _starts(
    pixels: Float[np.ndarray, "n 2"], points: Float64[np.ndarray, "n 3"]
) -> Iterator[Float64[np.ndarray, "7"]]:
    """Rotation vector and translation (m) of T_camera_world, and the focal length's logarithm over nominal.

    First the nominal camera, then one for each way to put the axes, as far away as the points' spread says.
    """
    nominal = invert_pose(nominal_camera().T_world_camera)
    yield np.array([*Rotation.from_matrix(nominal[:3, :3]).as_rotvec(), *nominal[:3, 3], 0.0])
    rays = _rays(pixels, NOMINAL_FOCAL_PX)
    distance = points.std(axis=0).max() / rays.std(axis=0).max()
    for rotation in Rotation.create_group("O"):
        shift = distance * rays.mean(axis=0) - rotation.apply(points.mean(axis=0))
        yield np.array([*rotation.as_rotvec(), *shift, 0.0])


def _misses(
    parameters: Float64[np.ndarray, "7"], pixels: Float[np.ndarray, "n 2"], points: Float64[np.ndarray, "n 3"]
) -> Float64[np.ndarray, "misses"]:
    """Differences between the directions of pixels and points, in about pixels; smooth behind the camera.

    The last is that of the focal length from the nominal one. It decides where a plane is seen straight on.
    """
    rays = _rays(pixels, _focal(parameters))
    seen = Rotation.from_rotvec(parameters[:3]).apply(points) + parameters[3:6]
    seen /= np.linalg.norm(seen, axis=1, keepdims=True) + 1e-12
    return np.append(NOMINAL_FOCAL_PX * (rays - seen).ravel(), FOCAL_WEIGHT * parameters[6])


def _slopes(
    parameters: Float64[np.ndarray, "7"], pixels: Float[np.ndarray, "n 2"], points: Float64[np.ndarray, "n 3"]
) -> Float64[np.ndarray, "misses 7"]:
    """Derivatives of `_misses` by the parameters."""
    turned = Rotation.from_rotvec(parameters[:3]).apply(points)
    seen = turned + parameters[3:6]
    length = np.linalg.norm(seen, axis=1)[:, None, None] + 1e-12
    unit = seen[:, :, None] / length
    by_shift = (np.eye(3) - unit @ unit.swapaxes(1, 2)) / length
    by_turn = -by_shift @ _cross(turned) @ _turn_of_rotvec(parameters[:3])
    rays = _rays(pixels, _focal(parameters))
    shrunk = rays * (-1, -1, 0) * (abs(parameters[6]) <= 1)
    by_focal = shrunk - rays * (rays * shrunk).sum(axis=1, keepdims=True)
    slopes = np.concatenate((-by_turn, -by_shift, by_focal[:, :, None]), axis=2).reshape(-1, 7)
    last = np.array([[0, 0, 0, 0, 0, 0, FOCAL_WEIGHT]])
    return np.concatenate((NOMINAL_FOCAL_PX * slopes, last))


def _cross(vectors: Float64[np.ndarray, "*n 3"]) -> Float64[np.ndarray, "*n 3 3"]:
    """Matrices C with C w = v x w for each vector v."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = np.stack((zero, -z, y, z, zero, -x, -y, x, zero), axis=-1)
    matrices: Float64[np.ndarray, "*n 3 3"] = rows.reshape(*vectors.shape, 3)
    return matrices


def _turn_of_rotvec(rotvec: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "3 3"]:
    """What a small change of a rotation vector turns by: the left Jacobian of SO(3)."""
    angle, cross = float(np.linalg.norm(rotvec)), _cross(rotvec)
    if angle < 1e-6:
        return np.eye(3) + cross / 2
    turn: Float64[np.ndarray, "3 3"] = (
        np.eye(3)
        + (1 - np.cos(angle)) / angle**2 * cross
        + (angle - np.sin(angle)) / angle**3 * cross @ cross
    )
    return turn


def _focal(parameters: Float64[np.ndarray, "7"]) -> float:
    return float(NOMINAL_FOCAL_PX * np.exp(np.clip(parameters[6], -1, 1)))


def _rays(pixels: Float[np.ndarray, "n 2"], focal: float) -> Float64[np.ndarray, "n 3"]:
    """Unit vectors through pixels, in the camera's frame."""
    offset = (pixels - np.array([WIDTH - 1, HEIGHT - 1]) / 2) / focal
    rays = np.column_stack((offset, np.ones(len(pixels))))
    unit: Float64[np.ndarray, "n 3"] = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit


def _camera(focal: float, T_base_camera: Float[np.ndarray, "4 4"]) -> Camera:
    return Camera(WIDTH, HEIGHT, focal, focal, (WIDTH - 1) / 2, (HEIGHT - 1) / 2, T_base_camera)
