"""Normals and curvature of the surface that a depth image shows."""

import numpy as np
from jaxtyping import Float32

from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation

REACH_PX = 6
STEP_PX = 2
MIN_NEIGHBOURS = 12
MAX_JUMP = 0.02
STRIP_ROWS = 4
"""Rows whose neighbours are summed at once: few enough to stay in the processor's cache."""
BLOCK_ROWS = 48
"""Rows whose covariances are worked on at once: few enough as well, and fewer calls."""

_STEPS = np.arange(-REACH_PX, REACH_PX + 1, STEP_PX, dtype=np.float32)
_V, _U = (grid.ravel() for grid in np.meshgrid(_STEPS, _STEPS, indexing="ij"))
MOMENTS = np.stack((np.ones_like(_U), _U, _V, _U * _U, _U * _V, _V * _V))
"""1, u, v, uu, uv and vv of the neighbours' offsets (u, v): their weights in the sums behind a covariance."""


def normals_and_curvature(
    observation: Observation,
) -> tuple[Float32[np.ndarray, "h w 3"], Float32[np.ndarray, "h w"]]:
    """Unit normals towards the camera (camera frame) and curvature of each pixel; NaN where unknown.

    Both come from the covariance of a pixel's neighbours in the organised cloud: every second pixel of
    13 x 13 around it, 49 in all, where the authors take the 50 nearest points at many times the cost.
    Neighbours whose depth differs by more than `MAX_JUMP` of the pixel's own lie on another surface and do
    not count. Curvature is the smallest eigenvalue over the sum of all three: 0 on a plane, at most 1/3.
    """
    # A pixel of depth 0 has no neighbour and is nobody's.
    depth = np.nan_to_num(observation.depth)
    window = (2 * REACH_PX + 1, 2 * REACH_PX + 1)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(depth, REACH_PX), window)
    neighbours = np.moveaxis(around[:, :, ::STEP_PX, ::STEP_PX], (2, 3), (0, 1))
    ray_x, ray_y = observation.camera.rays(np.float32)
    normals = np.empty((3, *depth.shape), dtype=np.float32)
    curvature = np.empty(depth.shape, dtype=np.float32)
    for top in range(0, len(depth), BLOCK_ROWS):
        rows = slice(top, top + BLOCK_ROWS)
        pixels = _pixel_covariance(depth[rows], neighbours[:, :, rows])
        covariance = _metric_covariance(pixels, ray_x, ray_y[rows], observation.camera)
        normal, smallest = _smallest_eigenpair(covariance)
        towards_pixel = normal[0] * ray_x + normal[1] * ray_y[rows] + normal[2]
        np.copysign(1, -towards_pixel, out=towards_pixel)
        np.multiply(normal, towards_pixel, out=normals[:, rows])
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.maximum(smallest / (covariance[0] + covariance[3] + covariance[5]), 0)
        curvature[rows] = np.where(np.isnan(normal[0]), np.nan, share)
    return np.moveaxis(normals, 0, -1), curvature


def _pixel_covariance(
    depth: Float32[np.ndarray, "h w"], neighbours: Float32[np.ndarray, "k k h w"]
) -> Float32[np.ndarray, "6 h w"]:
    """Covariance (m^2) of (u z, v z, d) of each pixel's neighbours: uu, uv, ud, vv, vd, dd; NaN if too few.

    A neighbour is (u, v) pixels away, of depth z and d deeper than the pixel itself. Sums run over d, not z,
    so that single precision is enough.
    """
    sums = np.empty((3, *MOMENTS.shape[:1], *depth.shape), dtype=np.float32)
    for top in range(0, len(depth), STRIP_ROWS):
        rows = slice(top, top + STRIP_ROWS)
        powers = _powers(depth[rows], neighbours[:, :, rows])
        sums[:, :, rows] = (MOMENTS @ powers).reshape(sums[:, :, rows].shape)
    count = sums[0, 0].copy()
    count[count < MIN_NEIGHBOURS] = np.nan
    (_, n_u, n_v, n_uu, n_uv, n_vv), (d, d_u, d_v, d_uu, d_uv, d_vv), (dd, dd_u, dd_v, *dd_2) = sums / count
    mean_u, mean_v = depth * n_u + d_u, depth * n_v + d_v
    uu, uv, vv = (
        depth * (depth * n_2 + 2 * d_2) + dd_2
        for n_2, d_2, dd_2 in zip((n_uu, n_uv, n_vv), (d_uu, d_uv, d_vv), dd_2, strict=True)
    )
    return np.stack(
        (
            uu - mean_u * mean_u,
            uv - mean_u * mean_v,
            depth * d_u + dd_u - mean_u * d,
            vv - mean_v * mean_v,
            depth * d_v + dd_v - mean_v * d,
            dd - d * d,
        )
    )


def _powers(
    depth: Float32[np.ndarray, "h w"], neighbours: Float32[np.ndarray, "k k h w"]
) -> Float32[np.ndarray, "3 k*k h*w"]:
    """d^0, d^1 and d^2 of neighbours d deeper than the pixel; 0 for neighbours that do not count."""
    powers = np.empty((3, *neighbours.shape), dtype=np.float32)
    near, jump, square = powers
    np.subtract(neighbours, depth, out=jump)
    np.abs(jump, out=square)
    np.less(square, np.float32(MAX_JUMP) * depth, out=near, casting="unsafe")
    jump *= near
    np.multiply(jump, jump, out=square)
    return powers.reshape(3, MOMENTS.shape[1], -1)


def _metric_covariance(
    pixels: Float32[np.ndarray, "6 h w"],
    ray_x: Float32[np.ndarray, "1 w"],
    ray_y: Float32[np.ndarray, "h 1"],
    camera: Camera,
) -> Float32[np.ndarray, "6 h w"]:
    """Covariance (m^2) of the neighbours' points: xx, xy, xz, yy, yz, zz.

    A neighbour's point lies at (x d + u z / fx, y d + v z / fy, d) from that of a pixel with the ray (x, y).
    """
    uu, uv, ud, vv, vd, dd = pixels
    uu, uv, ud = uu / camera.fx**2, uv / (camera.fx * camera.fy), ud / camera.fx
    vv, vd = vv / camera.fy**2, vd / camera.fy
    xz, yz = ud + ray_x * dd, vd + ray_y * dd
    xx, yy = uu + ray_x * (ud + xz), vv + ray_y * (vd + yz)
    return np.stack((xx, uv + ray_x * vd + ray_y * xz, xz, yy, yz, dd))


def _smallest_eigenpair(
    matrix: Float32[np.ndarray, "6 h w"],
) -> tuple[Float32[np.ndarray, "3 h w"], Float32[np.ndarray, "h w"]]:
    """Unit eigenvector and value of the smallest eigenvalue of symmetric matrices, in closed form.

    The eigenvalues are the roots of a cubic with three real roots (Smith 1961). The adjugate of the matrix
    less its eigenvalue has the eigenvector in every row; the row with the largest diagonal entry is the
    longest.
    """
    xx, xy, xz, yy, yz, zz = matrix
    mean = (xx + yy + zz) / 3
    a, b, c = xx - mean, yy - mean, zz - mean
    spread = np.sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    half_det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    with np.errstate(invalid="ignore", divide="ignore"):
        angle = np.arccos(np.clip(half_det / (2 * spread * spread * spread), -1, 1)) / 3
    smallest = mean + 2 * spread * np.cos(angle + 2 * np.pi / 3)
    a, b, c = xx - smallest, yy - smallest, zz - smallest
    adjugate_x, adjugate_y, adjugate_z = b * c - yz * yz, a * c - xz * xz, a * b - xy * xy
    adjugate_xy, adjugate_xz, adjugate_yz = xz * yz - xy * c, xy * yz - b * xz, xy * xz - a * yz
    by_x, by_y = adjugate_x >= np.maximum(adjugate_y, adjugate_z), adjugate_y >= adjugate_z
    normal = np.stack(
        (
            np.where(by_x, adjugate_x, np.where(by_y, adjugate_xy, adjugate_xz)),
            np.where(by_x, adjugate_xy, np.where(by_y, adjugate_y, adjugate_yz)),
            np.where(by_x, adjugate_xz, np.where(by_y, adjugate_yz, adjugate_z)),
        )
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        return normal / np.sqrt((normal * normal).sum(axis=0)), smallest
