"""Normals and curvature: right on planes and spheres, unknown where the depth is."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from preshape.geometry.camera import Camera
from preshape.perception.image import CHANNEL_NAMES, eight_channel_image
from preshape.perception.observation import Observation
from preshape.perception.surface import normals_and_curvature

CAMERA = Camera(160, 120, 525.0, 525.0, 79.5, 59.5, np.eye(4))


def observe(depth: np.ndarray) -> Observation:
    return Observation(np.zeros((*depth.shape, 3), np.uint8), depth.astype(np.float32), None, CAMERA)


def rays() -> np.ndarray:
    return CAMERA.unproject(np.ones((CAMERA.height, CAMERA.width)))


def plane_depth(normal: np.ndarray, distance: float) -> np.ndarray:
    """Depth of the plane at a distance along the optical axis."""
    return distance * normal[2] / (rays() @ normal)


def angle_degrees(normals: np.ndarray, truth: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip(normals.astype(np.float64) @ truth, -1, 1)))


@pytest.mark.parametrize("tilt", [(0, 0), (30, 0), (-60, 0), (0, 45), (40, -35)])
def test_normals_of_a_tilted_plane(tilt: tuple[float, float]) -> None:
    normal = Rotation.from_euler("xy", tilt, degrees=True).apply([0.0, 0.0, -1.0])
    normals, curvature = normals_and_curvature(observe(plane_depth(normal, 1.1)))
    assert angle_degrees(normals, normal).max() < 1.0
    assert curvature.max() < 1e-4


def test_normals_of_a_noisy_plane() -> None:
    normal = Rotation.from_euler("x", 45, degrees=True).apply([0.0, 0.0, -1.0])
    depth = plane_depth(normal, 1.1)
    noisy = depth + np.random.default_rng(0).normal(0, 0.0025, depth.shape)
    assert np.median(angle_degrees(normals_and_curvature(observe(noisy))[0], normal)) < 4.0


def test_normals_and_curvature_of_a_sphere() -> None:
    centre, radius = np.array([0.0, 0.0, 1.0]), 0.06
    along = rays() @ centre
    square = along**2 - (rays() ** 2).sum(-1) * (centre @ centre - radius**2)
    depth = np.where(square > 0, (along - np.sqrt(np.maximum(square, 0))) / (rays() ** 2).sum(-1), np.nan)
    normals, curvature = normals_and_curvature(observe(depth))
    outward = (CAMERA.unproject(depth) - centre) / radius
    middle = outward[..., 2] < -0.7
    error = np.degrees(np.arccos(np.clip((normals * outward).sum(-1)[middle], -1, 1)))
    assert np.median(error) < 1.5
    assert error.max() < 4.0  # beside the rim all neighbours are on one side
    assert curvature[middle].min() > 1e-4


def test_curvature_is_higher_on_an_edge_than_beside_it(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.15, 0.15, 0.1), yaw=np.pi / 4))
    _, curvature = normals_and_curvature(observation)
    corner = np.array([0.8, -0.15 / np.sqrt(2), table_top.height_m + 0.05])
    T_world_camera = observation.camera.T_world_camera
    u, v = observation.camera.project((corner - T_world_camera[:3, 3]) @ T_world_camera[:3, :3])
    edge = curvature[round(v), round(u) - 2 : round(u) + 3].max()
    assert edge > 0.05
    assert curvature[round(v), round(u) + 15] < 0.001


def test_all_normals_are_unit_vectors_towards_the_camera(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2), yaw=0.4), noise_seed=0)
    normals, curvature = normals_and_curvature(observation)
    known = np.isfinite(curvature)
    np.testing.assert_allclose(np.linalg.norm(normals[known], axis=-1), 1.0, atol=1e-5)
    points = observation.camera.unproject(observation.depth)
    assert ((normals * points).sum(-1)[known] <= 0).all()
    assert curvature[known].min() >= 0
    assert curvature[known].max() <= 1 / 3 + 1e-6


def test_a_jump_in_depth_does_not_bend_the_normals() -> None:
    depth = np.full((120, 160), 1.0)
    depth[:, 80:] = 1.2
    normals, curvature = normals_and_curvature(observe(depth))
    assert angle_degrees(normals, np.array([0.0, 0.0, -1.0])).max() < 0.1
    assert curvature.max() < 1e-6


def test_unknown_where_the_sensor_saw_nothing() -> None:
    depth = np.ones((120, 160))
    depth[40:80, 40:80] = np.nan
    normals, curvature = normals_and_curvature(observe(depth))
    assert np.isnan(normals[40:80, 40:80]).all()
    assert np.isnan(curvature[40:80, 40:80]).all()
    assert np.isfinite(curvature[:, 80:]).all()
    blind, _ = normals_and_curvature(observe(np.full((120, 160), np.nan)))
    assert np.isnan(blind).all()


def test_no_seams_between_strips(table_top: Any) -> None:
    """A view moved down by some rows gives normals that moved with it."""
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)), noise_seed=0)
    camera, shift = observation.camera, 7
    moved = Camera(
        camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy + shift, camera.T_world_camera
    )
    depth = np.roll(observation.depth, shift, axis=0)
    here = normals_and_curvature(observation)[0][20:400]
    there = normals_and_curvature(Observation(observation.rgb, depth, None, moved))[0]
    there = there[20 + shift : 400 + shift]
    both = np.isfinite(here).all(-1) & np.isfinite(there).all(-1)
    assert both.sum() == np.isfinite(here).all(-1).sum()
    assert np.abs(here - there)[both].mean() < 1e-4


def test_eight_channels(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)), noise_seed=0)
    image = eight_channel_image(observation)
    assert image.shape == (len(CHANNEL_NAMES), 480, 640)
    assert np.isfinite(image).all()
    unknown = np.isnan(observation.depth)
    assert (image[3:, unknown] == 0).all()
    np.testing.assert_array_equal(image[3][~unknown], observation.depth[~unknown])
    np.testing.assert_allclose(image[:3] * 255, np.moveaxis(observation.rgb, -1, 0), atol=1e-3)
    np.testing.assert_array_equal(image, eight_channel_image(observation))
