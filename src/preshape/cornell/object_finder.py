"""The object in an image of a table, found by its height and by its colour.

Objects of the Cornell data can be as flat as a pen, which depth cannot tell from the table, or have its
colour.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from preshape.errors import InputError
from preshape.perception.observation import Observation
from preshape.perception.point_cloud import clusters
from preshape.perception.table import Table, TableSettings, find_table


@dataclass(frozen=True)
class FinderSettings:
    """What counts as an object.

    Args:
        min_height_m, max_height_m: how far over the table its higher points are.
        colour: least difference of a colour (0-1) from that of the table around it.
        margin_m: it keeps so far away from the edge of the table in view, where walls and floor begin.
        min_pixels: it has at least so many pixels.
        max_size: largest share of the image's width that it takes.
        gap_m: parts that are farther apart, among the higher ones, are different things.
        fill_px: gaps of this width within an object are closed.
        tall_share: an object with so large a share of higher pixels consists of them alone.
    """

    min_height_m: float = 0.012
    max_height_m: float = 0.35
    colour: float = 0.12
    margin_m: float = 0.05
    min_pixels: int = 60
    max_size: float = 0.5
    gap_m: float = 0.015
    fill_px: int = 7
    tall_share: float = 0.3


def find_object(observation: Observation, settings: FinderSettings | None = None) -> Bool[np.ndarray, "h w"]:
    """Pixels of the object on the table: the largest region that is higher, or of another colour.

    Raises:
        InputError: if no table is in view, or nothing lies on it.
    """
    settings = settings or FinderSettings()
    points = observation.camera.unproject(observation.depth.astype(np.float64))
    table = find_table(points, observation.camera.T_world_camera[2, :3], TableSettings())
    height = table.height(points)
    inside = _over_table(points, height, table, settings)
    higher = inside & (height > settings.min_height_m) & (height < settings.max_height_m)
    colour = observation.rgb.astype(np.float64) / 255
    other = inside & (_colour_difference(colour, inside & ~higher) > settings.colour)
    apart = np.zeros(higher.shape, dtype=np.int64)
    # a wall behind the object may touch it in the image
    apart[higher] = 1 + clusters(points[higher], voxel_m=settings.gap_m / 3, distance_m=settings.gap_m)
    joined, _ = ndimage.label(_closed(ndimage.binary_opening(higher | other), settings.fill_px))
    regions = [own for labels in (apart, joined) for own in _regions(labels, settings)]
    if not regions:
        raise InputError(
            "No object lies on the table in this view",
            where="colour and depth image",
            fix="put one object near the middle of the table and in full view",
        )
    found = max(regions, key=_prominence)
    # what is of another colour beside something tall is its shadow
    tall = found & higher
    return tall if tall.sum() > settings.tall_share * found.sum() else found


def centre_of(mask: Bool[np.ndarray, "h w"]) -> tuple[float, float]:
    """Mean pixel (u, v) of an object."""
    v, u = np.nonzero(mask)
    return float(u.mean()), float(v.mean())


def _over_table(
    points: Float[np.ndarray, "h w 3"],
    height: Float[np.ndarray, "h w"],
    table: Table,
    settings: FinderSettings,
) -> Bool[np.ndarray, "h w"]:
    """Pixels whose point lies over the table, off its edge; those without a point are what is around them."""
    known = np.isfinite(height)
    inside = np.zeros(height.shape, dtype=bool)
    inside[known] = table.covers(points[known], -settings.margin_m)
    inside &= height > -settings.min_height_m
    return _closed(inside, 15)


def _colour_difference(
    colour: Float[np.ndarray, "h w 3"], table: Bool[np.ndarray, "h w"]
) -> Float[np.ndarray, "h w"]:
    """Largest difference of a pixel's colours from the table's, which change slowly over the image.

    The table's colours are quadratic in the pixel's coordinates, fitted to the pixels of the table again and
    again without those that are farthest off: the object's own.
    """
    h, w = table.shape
    v, u = np.meshgrid(np.linspace(-1, 1, h), np.linspace(-1, 1, w), indexing="ij")
    basis = np.stack((np.ones_like(u), u, v, u * u, u * v, v * v), axis=-1)
    rows = np.flatnonzero(table.ravel())[::7]
    flat, samples = basis.reshape(-1, 6)[rows], colour.reshape(-1, 3)[rows]
    used = np.ones(len(rows), dtype=bool)
    fit = np.zeros((6, 3))
    for _ in range(4):
        if used.sum() < len(fit):
            break
        fit = np.linalg.lstsq(flat[used], samples[used], rcond=None)[0]
        off = np.abs(flat @ fit - samples).max(axis=1)
        used = off <= np.quantile(off, 0.8)
    difference: Float[np.ndarray, "h w"] = np.abs(basis @ fit - colour).max(axis=-1)
    return difference


def _regions(labels: Int[np.ndarray, "h w"], settings: FinderSettings) -> list[Bool[np.ndarray, "h w"]]:
    """Labelled parts of an image that can be an object by their size."""
    limit = settings.max_size * labels.shape[1]
    sizes = np.bincount(labels.ravel())
    return [
        labels == label
        for label, (rows, columns) in enumerate(ndimage.find_objects(labels), start=1)
        if sizes[label] >= settings.min_pixels
        and max(rows.stop - rows.start, columns.stop - columns.start) <= limit
    ]


def _prominence(region: Bool[np.ndarray, "h w"]) -> float:
    """Number of pixels, which count less far from the middle of the image."""
    u, v = centre_of(region)
    h, w = region.shape
    away = np.hypot(u - (w - 1) / 2, v - (h - 1) / 2) / (w / 4)
    return float(region.sum() / (1 + away**2))


def _closed(mask: Bool[np.ndarray, "h w"], size: int) -> Bool[np.ndarray, "h w"]:
    """The mask without gaps narrower than some pixels."""
    closed: Bool[np.ndarray, "h w"] = ndimage.minimum_filter(ndimage.maximum_filter(mask, size), size)
    return closed
