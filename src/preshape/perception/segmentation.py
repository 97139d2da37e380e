"""The object on the table: its points, its pixels and its bounding box (paper, section 4.1)."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Integer

from preshape.errors import InputError
from preshape.perception.bounding_box import upright_box
from preshape.perception.observation import Observation
from preshape.perception.point_cloud import clusters
from preshape.perception.table import Table, TableSettings, find_table


@dataclass(frozen=True)
class SegmentationSettings:
    """How the object is told from the table, the robot and the floor.

    Args:
        table: how the table is found.
        min_height_m: points lower than this over the table are taken for the table.
        max_height_m: points higher than this are not looked at.
        voxel_m: edge of the voxels to which the points are thinned for clustering.
        cluster_distance_m: largest gap within one object.
        min_pixels: an object has at least so many pixels.
        max_gap_below_m: the lowest point of an object is at most so high over the table (an arm hovers).
        workspace_radius_m: an object's centre lies at most so far from the middle of the table in view.
        table_margin_m: how far an object may stand out over the edge of the table in view.
        min_share_over_table: least share of an object's points over the table (an arm reaches in).
    """

    table: TableSettings = field(default_factory=TableSettings)
    min_height_m: float = 0.008
    max_height_m: float = 0.5
    voxel_m: float = 0.004
    cluster_distance_m: float = 0.015
    min_pixels: int = 150
    max_gap_below_m: float = 0.03
    workspace_radius_m: float = 0.35
    table_margin_m: float = 0.02
    min_share_over_table: float = 0.9


@dataclass(frozen=True, eq=False)
class SegmentedObject:
    """The object in one view. All in the camera frame and in metres.

    Args:
        points: the object's points.
        mask: the object's pixels.
        plane: the table's plane (a, b, c, d): unit normal up, n . p + d is the height of p over the table.
        T_camera_box: pose of the upright bounding box: origin at its centre, z up, x along its longer
            horizontal axis.
        extents: lengths of the box along its x, y and z.
    """

    points: Float[np.ndarray, "n 3"]
    mask: Bool[np.ndarray, "h w"]
    plane: Float[np.ndarray, "4"]
    T_camera_box: Float[np.ndarray, "4 4"]
    extents: Float[np.ndarray, "3"]


def segment(observation: Observation, settings: SegmentationSettings) -> SegmentedObject:
    """Find the one object on the table: plane by RANSAC, points above it, the object's cluster, its box.

    Only the depth and the camera are used. The result is a function of the arguments alone.

    Raises:
        InputError: no table is in view, or no object stands on it.
    """
    camera = observation.camera
    points = camera.unproject(observation.depth.astype(np.float64))
    world_up = camera.T_world_camera[2, :3]
    table = find_table(points, world_up, settings.table)
    height = table.height(points)
    # Comparisons with NaN are false, so unknown pixels drop out here.
    above = (height > settings.min_height_m) & (height < settings.max_height_m)
    labels = clusters(points[above], voxel_m=settings.voxel_m, distance_m=settings.cluster_distance_m)
    mask = np.zeros_like(above)
    mask[above] = labels == _object_label(points[above], labels, table, settings)
    T_camera_box, extents = upright_box(points[mask], table)
    return SegmentedObject(points[mask], mask, table.plane, T_camera_box, extents)


def _object_label(
    points: Float[np.ndarray, "n 3"],
    labels: Integer[np.ndarray, "n"],
    table: Table,
    settings: SegmentationSettings,
) -> int:
    """Label of the largest cluster that stands on the table within the workspace."""
    sizes = np.bincount(labels[labels >= 0])
    for label in np.argsort(-sizes, kind="stable"):
        if sizes[label] < settings.min_pixels:
            break
        if _stands_on_table(points[labels == label], table, settings):
            return int(label)
    raise InputError(
        "No object stands on the table in this view",
        where="depth image",
        fix="put one object, at least 1.5 cm tall, near the middle of the table and in full view",
    )


def _stands_on_table(points: Float[np.ndarray, "n 3"], table: Table, settings: SegmentationSettings) -> bool:
    """Whether a cluster stands on the table within the workspace, rather than reaching in from outside."""
    offset = table.axes @ (points.mean(axis=0) - table.centre)
    return bool(
        table.height(points).min() < settings.max_gap_below_m
        and np.linalg.norm(offset) < settings.workspace_radius_m
        and table.covers(points, settings.table_margin_m).mean() > settings.min_share_over_table
    )
