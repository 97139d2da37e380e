"""The rectangle metric, by which grasps on the Cornell data count as right (Jiang et al., ICRA 2011)."""

import math
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float

from preshape.cornell.rectangle import GraspRectangle

MIN_JACCARD = 0.25
MAX_ANGLE_RAD = math.radians(30)


def is_correct(predicted: GraspRectangle, positives: Iterable[GraspRectangle]) -> bool:
    """Whether any labelled positive rectangle of the image is turned by at most 30 degrees against the
    predicted one, and their Jaccard index is at least 0.25.
    """
    return any(
        angle_between(predicted, positive) <= MAX_ANGLE_RAD and jaccard(predicted, positive) >= MIN_JACCARD
        for positive in positives
    )


def angle_between(one: GraspRectangle, other: GraspRectangle) -> float:
    """Angle (rad) between two grasps, at most pi / 2: half a turn makes no difference."""
    apart = abs(one.angle_rad - other.angle_rad)
    return min(apart, math.pi - apart)


def jaccard(one: GraspRectangle, other: GraspRectangle) -> float:
    """Area of the intersection over that of the union of two rectangles; 0 if neither has an area."""
    shared = _area(_clipped(one.corners(), other.corners()))
    union = one.opening_px * one.jaw_px + other.opening_px * other.jaw_px - shared
    return shared / union if union > 0 else 0.0


def _clipped(polygon: Float[np.ndarray, "n 2"], window: Float[np.ndarray, "m 2"]) -> Float[np.ndarray, "k 2"]:
    """The part of a convex polygon within another (Sutherland and Hodgman 1974); both run the same way."""
    for start, end in zip(window, np.roll(window, -1, axis=0), strict=True):
        if not len(polygon):
            break
        edge = end - start
        inside = edge[0] * (polygon[:, 1] - start[1]) - edge[1] * (polygon[:, 0] - start[0])
        kept: list[Float[np.ndarray, "2"]] = []
        for i, depth in enumerate(inside):
            before = inside[i - 1]
            if (before < 0) != (depth < 0):
                kept.append(polygon[i - 1] + (polygon[i] - polygon[i - 1]) * before / (before - depth))
            if depth >= 0:
                kept.append(polygon[i])
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def _area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Area of a convex polygon (shoelace formula)."""
    after = np.roll(polygon, -1, axis=0)
    return abs(float((polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]).sum())) / 2
