"""Patches show the 8-channel image around their centre, unscaled, and zero beyond it."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.geometry.camera import Camera
from preshape.perception.image import eight_channel_image
from preshape.perception.observation import Observation
from preshape.perception.patch import PATCH_SIZE, object_centre, object_patch
from preshape.perception.segmentation import SegmentationSettings, segment

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
    centre = object_centre(segmented.T_camera_box, observation.camera)
    rows, columns = np.nonzero(segmented.mask)
    assert abs(rows.mean() - centre[1]) < 20
    assert abs(columns.mean() - centre[0]) < 10
    patch, half = object_patch(observation, centre), PATCH_SIZE // 2
    u, v = round(centre[0]), round(centre[1])
    np.testing.assert_array_equal(patch[:3, half, half], observation.rgb[v, u].astype(np.float32) / 255)
