"""The table under the object: its plane by RANSAC and the region of that plane that the camera sees."""

from dataclasses import dataclass

import numpy as np
import open3d as o3d
from jaxtyping import Bool, Float
from scipy.spatial import ConvexHull

from preshape.errors import InputError
from preshape.geometry.pose import pose_over_plane
from preshape.perception.point_cloud import largest_cluster


@dataclass(frozen=True)
class TableSettings:
    """How the table is found.

    Args:
        view_share: share of the image's width and height, around its centre, in which the table is the
            largest horizontal plane. In the whole image the floor beside a small table may be larger.
        inlier_distance_m: how far a point of the table may lie from its plane.
        iterations: RANSAC iterations for each plane tried.
        planes: how many planes are tried until one is horizontal.
        min_share: least share of the points in the centre of the view that the table must hold.
        max_tilt_rad: largest angle between the plane's normal and the world's up.
        seed: seed of RANSAC.
    """

    view_share: float = 0.6
    inlier_distance_m: float = 0.01
    iterations: int = 300
    planes: int = 4
    min_share: float = 0.1
    max_tilt_rad: float = 0.26
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Table:
    """The table's plane and the part of it in view.

    Args:
        plane: (a, b, c, d) with the unit normal (a, b, c) pointing up; n . p + d is the height of p in m.
        centre: middle of the table in the centre of the view.
        axes: two unit vectors that span the plane, as rows.
        edges: half-planes (a, b, c) of the convex region of the table in view, in coordinates along `axes`:
            a x + b y + c <= 0 inside.
    """

    plane: Float[np.ndarray, "4"]
    centre: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "2 3"]
    edges: Float[np.ndarray, "e 3"]

    def height(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
        """Height of points over the table (m)."""
        height: Float[np.ndarray, "*n"] = points @ self.plane[:3] + self.plane[3]
        return height

    def covers(self, points: Float[np.ndarray, "n 3"], margin_m: float) -> Bool[np.ndarray, "n"]:
        """Which points lie over the table in view, or outside of it by no more than the margin."""
        distances = points @ self.axes.T @ self.edges[:, :2].T + self.edges[:, 2]
        return np.asarray(distances.max(axis=-1) <= margin_m)


def find_table(
    points: Float[np.ndarray, "h w 3"], up: Float[np.ndarray, "3"], settings: TableSettings
) -> Table:
    """The table in organised points (m, camera frame, NaN where unknown).

    Args:
        points: organised point cloud.
        up: the world's up as a unit vector in the camera frame.
        settings: how the table is found.

    Raises:
        InputError: no large horizontal plane is in the centre of the view.
    """
    height, width = points.shape[:2]
    top, left = (round(n * (1 - settings.view_share) / 2) for n in (height, width))
    central = points[top : height - top : 4, left : width - left : 4].reshape(-1, 3)
    plane, inliers = horizontal_plane(central[np.isfinite(central).all(axis=-1)], up, settings)
    sparse = points[::4, ::4].reshape(-1, 3)
    near = np.abs(sparse @ plane[:3] + plane[3]) < settings.inlier_distance_m
    region = largest_cluster(sparse[near], voxel_m=0.02, distance_m=0.05)
    axes = np.linalg.svd(plane[None, :3])[2][1:]
    return Table(plane, inliers.mean(axis=0), axes, ConvexHull(region @ axes.T).equations)


def horizontal_plane(
    points: Float[np.ndarray, "n 3"], up: Float[np.ndarray, "3"], settings: TableSettings
) -> tuple[Float[np.ndarray, "4"], Float[np.ndarray, "m 3"]]:
    """The largest plane of a cloud whose normal is within `max_tilt_rad` of `up`, and its inliers.

    Planes are taken from the cloud one after the other, the largest first, so that a wide vertical face does
    not hide the table.

    Raises:
        InputError: there is none that holds `min_share` of the points.
    """
    remaining = points
    enough = max(100, round(settings.min_share * len(points)))
    for _ in range(settings.planes):
        if len(remaining) < enough:
            break
        inliers = _inliers_of_largest_plane(remaining, settings)
        if inliers.sum() < enough:
            break
        plane = _fit_plane(remaining[inliers], up)
        if plane[:3] @ up > np.cos(settings.max_tilt_rad):
            return plane, remaining[inliers]
        remaining = remaining[~inliers]
    raise InputError(
        "No table is in view: no large horizontal plane lies around the centre of the depth image",
        where="depth image",
        fix="point the camera at the table, and check the depth's unit and the camera's T_world_camera",
    )


def _inliers_of_largest_plane(
    points: Float[np.ndarray, "n 3"], settings: TableSettings
) -> Bool[np.ndarray, "n"]:
    """Points near the best of the planes through random triples of points."""
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    o3d.utility.random.seed(settings.seed)
    # Open3D's threads race to the early stop; with probability 1 there is none, and the plane repeats.
    _, numbers = cloud.segment_plane(settings.inlier_distance_m, 3, settings.iterations, probability=1.0)
    inliers = np.zeros(len(points), dtype=bool)
    inliers[numbers] = True
    return inliers


def _fit_plane(points: Float[np.ndarray, "n 3"], up: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4"]:
    """Least-squares plane of points, its normal turned towards `up`."""
    centre = points.mean(axis=0)
    normal = np.linalg.eigh(np.cov((points - centre).T))[1][:, 0]
    normal = normal if normal @ up >= 0 else -normal
    return np.append(normal, -normal @ centre)


def camera_pose_over_table(points: Float[np.ndarray, "h w 3"]) -> Float[np.ndarray, "4 4"]:
    """T_world_camera of a camera of unknown pose that looks at a table, from organised points (m).

    The table's top is z = 0 under the camera, and x is the image's right along the table.

    Raises:
        InputError: no large plane that could be a table is in the centre of the view.
    """
    # Whether the camera looks level or straight down, the table's normal is within 45 degrees of this.
    up = np.array([0.0, -1.0, -1.0]) / np.sqrt(2)
    return pose_over_plane(find_table(points, up, TableSettings(max_tilt_rad=np.radians(55))).plane)
