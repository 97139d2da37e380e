"""The cameras of the BigBIRD data set: intrinsics, distortion and poses over the turntable."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, is_pose
from preshape.perception.bigbird_layout import bigbird_file
from preshape.perception.hdf5_files import Shape, read_hdf5

CALIBRATION = "calibration.h5"
POSE_KEY = "H_table_from_reference_camera"
REFERENCE = "NP5"
"""The camera over the turntable, from which the poses of all others are given."""
DEPTH_STEP_M = 1e-4
"""One unit of a depth image before the sensor's own scale."""
TURNED_OVER = np.diag([1.0, -1.0, -1.0, 1.0])
"""Half a turn about x."""


@dataclass(frozen=True, eq=False)
class BigbirdSensor:
    """One of the five RGB-D sensors at one angle of the turntable: a colour camera beside an infrared one.

    Args:
        rgb_intrinsics, depth_intrinsics: camera matrices (pixels) of the colour and of the depth image.
        distortion: of the colour image: k1, k2, p1, p2, k3 (Brown 1966, in OpenCV's order).
        depth_unit_m: metres for one unit of the depth image.
        T_world_rgb, T_world_ir: poses of the optical frames.
    """

    rgb_intrinsics: Float[np.ndarray, "3 3"]
    distortion: Float[np.ndarray, "5"]
    depth_intrinsics: Float[np.ndarray, "3 3"]
    depth_unit_m: float
    T_world_rgb: Float[np.ndarray, "4 4"]
    T_world_ir: Float[np.ndarray, "4 4"]

    def rgb_camera(self, size: tuple[int, int], full_size: tuple[int, int]) -> Camera:
        """The colour camera, freed of its distortion, for an image shrunk to a size.

        Args:
            size: width and height (pixels) of the shrunk image.
            full_size: those of the image for which the intrinsics hold.
        """
        return _pinhole(self.rgb_intrinsics, size, full_size, self.T_world_rgb)

    def depth_camera(self, size: tuple[int, int]) -> Camera:
        """The infrared camera, for a depth image of a width and height (pixels)."""
        return _pinhole(self.depth_intrinsics, size, size, self.T_world_ir)

    def distorted(
        self, x: Float[np.ndarray, "*n"], y: Float[np.ndarray, "*n"]
    ) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
        """Where the lens of the colour camera puts what a pinhole would show at (x, y), at depth 1."""
        k1, k2, p1, p2, k3 = self.distortion
        r2 = x**2 + y**2
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return (
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
            y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y,
        )


def read_bigbird_sensor(folder: Path, name: str, angle: int) -> BigbirdSensor:
    """Read the calibration of a sensor from an object's folder.

    The world is the frame of the turntable, which turns with it: z = 0 is its top, and an object has the same
    pose in the views of all angles. z points to the side on which the camera above it is, whichever way the
    file counts; if it counts downwards, y and z are turned over.

    Args:
        folder: the object's folder.
        name: `NP1` to `NP5`.
        angle: of the turntable (degrees).

    Raises:
        InputError: a file is missing or damaged, or holds something else than a calibration.
    """
    path = bigbird_file(folder, CALIBRATION)
    values = _read_calibration(path, name)
    intrinsics = [values[f"{name}_{image}_K"] for image in ("rgb", "depth")]
    T_camera_reference = [values[f"H_{name}{camera}_from_{REFERENCE}"] for camera in ("", "_ir")]
    unit_m = DEPTH_STEP_M * float(values[f"{name}_ir_depth_scale"][0])
    distortion = values[f"{name}_rgb_d"]
    _check(all(map(_is_intrinsic, intrinsics)), f"{name}_rgb_K or {name}_depth_K is no camera matrix", path)
    _check(all(map(is_pose, T_camera_reference)), "a camera's place is no pose", path)
    _check(0 < unit_m < np.inf, f"{name}_ir_depth_scale is not positive", path)
    _check(bool(np.isfinite(distortion).all()), f"{name}_rgb_d is not finite", path)
    T_world_reference = _reference_pose(folder, angle)
    T_world_rgb, T_world_ir = (T_world_reference @ invert_pose(pose) for pose in T_camera_reference)
    return BigbirdSensor(intrinsics[0], distortion, intrinsics[1], unit_m, T_world_rgb, T_world_ir)


def pose_file(folder: Path, angle: int) -> Path:
    """The file with the pose of the reference camera over the turntable at an angle (degrees)."""
    return bigbird_file(folder, f"poses/{REFERENCE}_{angle}_pose.h5")


def _read_calibration(path: Path, name: str) -> dict[str, Float[np.ndarray, "..."]]:
    """The arrays of one sensor; a lens without distortion is taken for ideal, the reference for itself."""
    given = {f"{name}_rgb_d": np.zeros(5), f"H_{REFERENCE}_from_{REFERENCE}": np.eye(4)}
    shapes: dict[str, Shape] = {
        f"{name}_rgb_K": (3, 3),
        f"{name}_rgb_d": (5,),
        f"{name}_depth_K": (3, 3),
        f"{name}_ir_depth_scale": (1,),
        f"H_{name}_from_{REFERENCE}": (4, 4),
        f"H_{name}_ir_from_{REFERENCE}": (4, 4),
    }
    found = read_hdf5(path, shapes, optional=given)
    return given | {key: value.astype(np.float64) for key, value in found.items()}


def _reference_pose(folder: Path, angle: int) -> Float[np.ndarray, "4 4"]:
    path = pose_file(folder, angle)
    pose = read_hdf5(path, {POSE_KEY: (4, 4)})[POSE_KEY].astype(np.float64)
    _check(is_pose(pose), f"{POSE_KEY} is not a pose", path)
    return pose if pose[2, 3] > 0 else TURNED_OVER @ pose


def _pinhole(
    K: Float[np.ndarray, "3 3"],
    size: tuple[int, int],
    full_size: tuple[int, int],
    pose: Float[np.ndarray, "4 4"],
) -> Camera:
    """Pixels have their centres at whole numbers, so the image begins half a pixel before the first."""
    along_x, along_y = size[0] / full_size[0], size[1] / full_size[1]
    fx, fy = float(K[0, 0] * along_x), float(K[1, 1] * along_y)
    cx, cy = float((K[0, 2] + 0.5) * along_x - 0.5), float((K[1, 2] + 0.5) * along_y - 0.5)
    return Camera(size[0], size[1], fx, fy, cx, cy, pose)


def _is_intrinsic(K: Float[np.ndarray, "3 3"]) -> bool:
    upright = np.array_equal(K[[1, 2, 2, 2], [0, 0, 1, 2]], [0.0, 0.0, 0.0, 1.0])
    return bool(np.isfinite(K).all() and upright and K[0, 0] > 0 and K[1, 1] > 0)


def _check(holds: bool, what: str, path: Path) -> None:
    if not holds:
        raise InputError(
            f"The HDF5 file does not fit: {what}", where=path, fix="extract or download it again"
        )
