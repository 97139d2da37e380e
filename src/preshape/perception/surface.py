"""Normals and curvature of the surface that a depth image shows."""

import numpy as np
from jaxtyping import Float, Float32

from preshape.perception.observation import Observation

REACH_PX = 6
STEP_PX = 2
MIN_NEIGHBOURS = 12
MAX_JUMP = 0.02
STRIP_ROWS = 16


def normals_and_curvature(
    observation: Observation,
) -> tuple[Float32[np.ndarray, "h w 3"], Float32[np.ndarray, "h w"]]:
    """Unit normals towards the camera (camera frame) and curvature of each pixel; NaN where unknown.

    Both come from the covariance of a pixel's neighbours in the organised cloud: every second pixel of
    13 x 13 around it, 49 in all, where the authors take the 50 nearest points at many times the cost.
    Neighbours whose depth differs by more than `MAX_JUMP` of the pixel's own lie on another surface and do
    not count. Curvature is the smallest eigenvalue over the sum of all three: 0 on a plane, at most 1/3.
    """
    points = np.moveaxis(observation.camera.unproject(observation.depth), -1, 0)
    # Unknown points at the camera itself have no neighbour and are nobody's.
    known = np.pad(np.nan_to_num(points), ((0, 0), (REACH_PX, REACH_PX), (REACH_PX, REACH_PX)))
    strips = [
        _strip(known[:, row : row + STRIP_ROWS + 2 * REACH_PX])
        for row in range(0, points.shape[1], STRIP_ROWS)
    ]
    normals, curvature = (np.concatenate(parts, axis=-2) for parts in zip(*strips, strict=True))
    return np.ascontiguousarray(np.moveaxis(normals, 0, -1)), curvature


def _strip(
    padded: Float32[np.ndarray, "3 padded_h padded_w"],
) -> tuple[Float32[np.ndarray, "3 h w"], Float32[np.ndarray, "h w"]]:
    """Normals and curvature of a strip of rows, narrow enough to stay in the processor's cache."""
    covariance = _local_covariance(padded)
    normals, smallest = _smallest_eigenpair(covariance)
    points = padded[:, REACH_PX:-REACH_PX, REACH_PX:-REACH_PX]
    normals *= np.where((normals * points).sum(axis=0) > 0, -1.0, 1.0)
    total = covariance[0, 0] + covariance[1, 1] + covariance[2, 2]
    with np.errstate(invalid="ignore", divide="ignore"):
        curvature = np.where(np.isnan(normals[0]), np.nan, np.maximum(smallest / total, 0.0))
    return normals.astype(np.float32), curvature.astype(np.float32)


def _local_covariance(padded: Float32[np.ndarray, "3 padded_h padded_w"]) -> Float[np.ndarray, "3 3 h w"]:
    """Covariance (m^2) of the neighbours of each pixel within the padding; NaN where too few are known.

    Sums run over offsets from the pixel's own point, so that single precision is enough.
    """
    points = padded[:, REACH_PX:-REACH_PX, REACH_PX:-REACH_PX]
    height, width = points.shape[1:]
    max_jump = MAX_JUMP * points[2]
    count = np.zeros((height, width), dtype=np.float32)
    first = np.zeros((3, height, width), dtype=np.float32)
    second = np.zeros((3, 3, height, width), dtype=np.float32)
    for v in range(0, 2 * REACH_PX + 1, STEP_PX):
        for u in range(0, 2 * REACH_PX + 1, STEP_PX):
            offset = padded[:, v : v + height, u : u + width] - points
            near = (np.abs(offset[2]) < max_jump).astype(np.float32)
            offset *= near
            count += near
            first += offset
            for i in range(3):
                for j in range(i, 3):
                    second[i, j] += offset[i] * offset[j]
    count[count < MIN_NEIGHBOURS] = np.nan
    mean = first / count
    for i in range(3):
        for j in range(i, 3):
            second[i, j] = second[j, i] = second[i, j] / count - mean[i] * mean[j]
    return second.astype(np.float64)


def _smallest_eigenpair(
    matrix: Float[np.ndarray, "3 3 h w"],
) -> tuple[Float[np.ndarray, "3 h w"], Float[np.ndarray, "h w"]]:
    """Unit eigenvector and value of the smallest eigenvalue of symmetric matrices, in closed form.

    The eigenvalues are the roots of a cubic with three real roots (Smith 1961); the eigenvector is
    perpendicular to the rows of the matrix less its eigenvalue, and the longest cross product of two rows
    is the best conditioned.
    """
    mean = (matrix[0, 0] + matrix[1, 1] + matrix[2, 2]) / 3
    eye = np.eye(3)[:, :, None, None]
    deviator = matrix - mean * eye
    spread = np.sqrt((deviator**2).sum(axis=(0, 1)) / 6)
    with np.errstate(invalid="ignore", divide="ignore"):
        half_det = _cross(deviator[0], deviator[1]) * deviator[2]
        angle = np.arccos(np.clip(half_det.sum(axis=0) / (2 * spread**3), -1, 1)) / 3
    smallest = mean + 2 * spread * np.cos(angle + 2 * np.pi / 3)
    rows = matrix - smallest * eye
    normal = _cross(rows[0], rows[1])
    length = (normal**2).sum(axis=0)
    for i, j in ((0, 2), (1, 2)):
        other = _cross(rows[i], rows[j])
        other_length = (other**2).sum(axis=0)
        longer = other_length > length
        normal[:, longer] = other[:, longer]
        length[longer] = other_length[longer]
    with np.errstate(invalid="ignore", divide="ignore"):
        return normal / np.sqrt(length), smallest


def _cross(a: Float[np.ndarray, "3 h w"], b: Float[np.ndarray, "3 h w"]) -> Float[np.ndarray, "3 h w"]:
    """Cross product of vector images, faster than `numpy.cross` along the first axis."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))
