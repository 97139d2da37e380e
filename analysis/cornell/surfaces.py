"""How good the surfaces of the Cornell data are: the table's flatness, approximate against measured depth."""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Bool, Float

from preshape.cornell.data_set import CornellDataSet
from preshape.cornell.layout import HEIGHT, WIDTH, ImageFiles
from preshape.cornell.views import Surface, load_surface
from preshape.perception.image import eight_channel_image
from preshape.perception.observation import Observation

Item = TypeVar("Item")
TABLE = (slice(HEIGHT // 2, HEIGHT - 20), slice(WIDTH // 5, WIDTH * 4 // 5))
"""Part of the image that shows the table, and the object on it."""
NEAR_M = 0.01
"""Pixels so near to the plane of the table are taken for it."""


def surface_figures(data: CornellDataSet, compared: int) -> dict[str, Any]:
    """Counts of surfaces, the table's flatness in the surfaces used, and differences where both are there.

    Args:
        data: the data set.
        compared: of so many images, spread over the data set, the surfaces are read.
    """
    files = [image.files for image in data.images]
    chosen = spread(files, compared)
    both = spread([own for own in files if own.cloud and own.range_image], compared)
    used = {Surface.MEASURED: [own for own in chosen if own.cloud]}
    used[Surface.APPROXIMATE] = [own for own in chosen if not own.cloud]
    return {
        "measured": sum(own.cloud is not None for own in files),
        "approximate": sum(own.cloud is None for own in files),
        "flatness": {
            surface.value: _medians([flatness(load_surface(own, surface)) for own in images])
            for surface, images in used.items()
            if images
        },
        "difference": _medians([difference(own) for own in both]) if both else None,
    }


def spread(items: Sequence[Item], n: int) -> list[Item]:
    """At most n of the images or their files, evenly spaced."""
    places = np.linspace(0, len(items) - 1, min(n, len(items))).astype(int)
    return [items[place] for place in places]


def flatness(view: Observation) -> dict[str, float]:
    """Distance of the table's pixels from their plane (m), and angle between their normals and its (rad).

    Both are medians; the plane is fitted to the pixels near it.
    """
    image = eight_channel_image(view)
    points = view.camera.unproject(view.depth.astype(np.float64))[TABLE].reshape(-1, 3)
    normals = image[4:7][:, *TABLE].reshape(3, -1).T.astype(np.float64)
    known = np.isfinite(points).all(axis=1) & normals.any(axis=1)
    points, normals = points[known], normals[known]
    near = np.ones(len(points), dtype=bool)
    for _ in range(10):
        normal, offset = _plane(points[near])
        off = np.abs(points @ normal - offset)
        near = off < max(NEAR_M, float(np.median(off)))
    return {
        "plane_m": float(np.median(off[near])),
        "normal_rad": float(np.median(np.arccos(np.clip(np.abs(normals[near] @ normal), -1, 1)))),
    }


def difference(files: ImageFiles) -> dict[str, float]:
    """Median difference of depth (m) and normals (rad) between the approximate and the measured surface."""
    measured, approximate = (eight_channel_image(load_surface(files, surface)) for surface in Surface)
    both = _known(measured) & _known(approximate)
    apart = np.abs(measured[3] - approximate[3])[both]
    cosine = (measured[4:7] * approximate[4:7]).sum(axis=0)[both]
    return {
        "depth_m": float(np.median(apart)),
        "normal_rad": float(np.median(np.arccos(np.clip(cosine, -1, 1)))),
    }


def _known(image: Float[np.ndarray, "8 h w"]) -> Bool[np.ndarray, "h w"]:
    known: Bool[np.ndarray, "h w"] = (image[3] > 0) & image[4:7].any(axis=0)
    return known


def _plane(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "3"], float]:
    """Unit normal n and offset n . p of the plane nearest to points."""
    centre = points.mean(axis=0)
    _, vectors = np.linalg.eigh(np.cov((points - centre).T))
    return vectors[:, 0], float(vectors[:, 0] @ centre)


def _medians(rows: list[dict[str, float]]) -> dict[str, float]:
    medians = {name: float(np.median([row[name] for row in rows])) for name in rows[0]}
    return {"images": len(rows)} | medians
