"""Patches show the image around their centre, unscaled, and zero beyond it."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from preshape.perception.patch import object_centre, object_patch
from preshape.perception.segmentation import SegmentationSettings, segment

IMAGE = np.random.default_rng(0).random((8, 48, 64), dtype=np.float32) + 0.5


@given(st.floats(-80, 150), st.floats(-80, 150), st.sampled_from([1, 7, 40, 41, 90]))
def test_patch_is_the_image_around_its_centre(u: float, v: float, size: int) -> None:
    patch = object_patch(IMAGE, (u, v), size)
    rows, columns = np.indices((size, size)) - size // 2
    rows, columns = rows + round(v), columns + round(u)
    inside = (rows >= 0) & (rows < 48) & (columns >= 0) & (columns < 64)
    assert patch.shape == (8, size, size)
    np.testing.assert_array_equal(patch[:, inside], IMAGE[:, rows[inside], columns[inside]])
    assert (patch[:, ~inside] == 0).all()


def test_object_is_in_the_middle_of_its_patch(table_top: Any) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2), (0.72, 0.08)), noise_seed=0)
    segmented = segment(observation, SegmentationSettings())
    mask = segmented.mask[None].astype(np.float32)
    patch = object_patch(mask, object_centre(segmented, observation.camera))
    assert patch.sum() == mask.sum()
    rows, columns = np.nonzero(patch[0])
    assert abs(rows.mean() - 200) < 20
    assert abs(columns.mean() - 200) < 10
