"""Patches show the 8-channel image around their centre, unscaled, and zero beyond it."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.geometry.camera import Camera
from preshape.perception.image import eight_channel_image
from preshape.perception.object_view import CLOUD_SIZE, PATCH_SIZE, object_cloud, object_patch
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, SegmentedObject, segment

RNG = np.random.default_rng(0)
WAVES = 1.0 + 0.01 * np.sin(np.indices((48, 64)).sum(axis=0) / 5)
WAVES[RNG.random(WAVES.shape) < 0.1] = np.nan
VIEW = Observation(
    RNG.integers(1, 256, (48, 64, 3), dtype=np.uint8),
    WAVES.astype(np.float32),
    None,
    Camera(64, 48, 60.0, 61.0, 31.5, 23.5, np.eye(4)),
)
IMAGE = eight_channel_image(VIEW)


@given(st.floats(-80, 150), st.floats(-80, 150), st.sampled_from([1, 7, 40, 41, 90]))
def test_patch_is_the_image_around_its_centre(u: float, v: float, size: int) -> None:
    patch = object_patch(VIEW, (u, v), size)
    rows, columns = np.indices((size, size)) - size // 2
    rows, columns = rows + round(v), columns + round(u)
    inside = (rows >= 0) & (rows < 48) & (columns >= 0) & (columns < 64)
    assert patch.shape == (8, size, size)
    seen = IMAGE[:, rows[inside], columns[inside]]
    np.testing.assert_array_equal(patch[:4, inside], seen[:4])
    np.testing.assert_allclose(patch[4:, inside], seen[4:], atol=1e-4)
    assert (patch[:, ~inside] == 0).all()


@pytest.mark.parametrize("place", [(0.72, 0.08), (0.9, -0.1)])
def test_the_object_is_in_the_middle_of_its_patch(table_top: Any, place: tuple[float, float]) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2), place), noise_seed=0)
    segmented = segment(observation, SegmentationSettings())
    centre = object_cloud(segmented).centre(observation.camera)
    patch = object_patch(observation, centre)
    rows, columns = np.nonzero(segmented.mask)
    assert abs(rows.mean() - centre[1]) < 20
    assert abs(columns.mean() - centre[0]) < 10
    half, u, v = PATCH_SIZE // 2, round(centre[0]), round(centre[1])
    seen = observation.rgb[v, u].astype(np.float32) / 255
    np.testing.assert_array_equal(patch[:3, half, half], seen)


@pytest.mark.parametrize("pixels", [200, CLOUD_SIZE, 5000])
def test_the_cloud_is_a_sample_of_the_objects_points(pixels: int) -> None:
    points = np.random.default_rng(0).normal(size=(pixels, 3))
    mask, plane = np.zeros((48, 64), dtype=bool), np.array([0.0, -1.0, 0.0, 0.5])
    segmented = SegmentedObject(points, mask, plane, np.eye(4), np.ones(3))
    cloud = object_cloud(segmented)
    assert {tuple(point) for point in cloud.points} <= {tuple(point) for point in points.astype(np.float32)}
    drawn, times = np.unique(cloud.points, axis=0, return_counts=True)
    assert len(drawn) == min(pixels, CLOUD_SIZE)
    assert times.max() == -(-CLOUD_SIZE // pixels)
    np.testing.assert_array_equal(object_cloud(segmented).points, cloud.points)
    np.testing.assert_array_equal(cloud.table, plane)
