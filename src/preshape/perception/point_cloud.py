"""Clusters of a point cloud."""

import numpy as np
import open3d as o3d
from jaxtyping import Float, Integer
from scipy.spatial import cKDTree


def clusters(
    points: Float[np.ndarray, "n 3"], *, voxel_m: float, distance_m: float
) -> Integer[np.ndarray, "n"]:
    """Number of the cluster of each point, -1 for noise.

    DBSCAN on the cloud thinned to voxels, because its cost grows with the number of neighbours.

    Args:
        points: point cloud (m).
        voxel_m: edge of the voxels.
        distance_m: largest distance between neighbours of one cluster.
    """
    if not len(points):
        return np.empty(0, dtype=np.int64)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points)).voxel_down_sample(voxel_m)
    labels = np.asarray(cloud.cluster_dbscan(distance_m, min_points=4))
    nearest = cKDTree(np.asarray(cloud.points)).query(points)[1]
    return np.asarray(labels[nearest])


def largest_cluster(
    points: Float[np.ndarray, "n 3"], *, voxel_m: float, distance_m: float
) -> Float[np.ndarray, "m 3"]:
    """Points of the cluster with the most points; all points if every one is noise."""
    labels = clusters(points, voxel_m=voxel_m, distance_m=distance_m)
    sizes = np.bincount(labels[labels >= 0])
    return points[labels == sizes.argmax()] if len(sizes) else points
