"""Stretched copies of objects have their centre of mass at the origin, the same density, and unit normals."""

import numpy as np
import pytest

from preshape.errors import InputError
from sim.objects.grocery import GrocerySet
from sim.objects.object_model import volume_and_centroid
from sim.stretched_objects import StretchedObjects, original_of

ORIGINALS = GrocerySet()
STRETCHED = StretchedObjects(ORIGINALS, copies=3, most=1.4)
CAN, BOX = "campbells_chicken_noodle_soup", "band_aid_clear_strips"


def test_the_set_holds_the_originals_and_all_copies() -> None:
    assert len(STRETCHED.names) == 4 * len(ORIGINALS.names)
    assert STRETCHED.names == tuple(sorted(set(STRETCHED.names)))
    assert {original_of(name) for name in STRETCHED.names} == set(ORIGINALS.names)
    assert STRETCHED.load(CAN) is ORIGINALS.load(CAN)


@pytest.mark.parametrize("name", [CAN, BOX, "blue_clover_baby_toy", "paper_plate"])
def test_a_copy_is_the_original_along_stretched_axes(name: str) -> None:
    original, copy = ORIGINALS.load(name), STRETCHED.load(f"{name}_stretched_1")
    factors = copy.size / original.size
    assert copy.object_id == f"{name}_stretched_1"
    np.testing.assert_array_less(np.abs(np.log(factors)), np.log(1.4) + 1e-9)
    volume, centroid = volume_and_centroid(copy.collision_parts)
    np.testing.assert_allclose(volume, original.volume_m3 * factors.prod())
    np.testing.assert_allclose(centroid, 0, atol=1e-6)
    assert copy.density == pytest.approx(original.density)
    for part, before in zip(copy.visual_parts, original.visual_parts, strict=True):
        np.testing.assert_allclose(part.vertices, before.vertices * factors, atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-5)


def test_normals_stay_across_their_faces() -> None:
    copy = STRETCHED.load(f"{CAN}_stretched_2")
    for part in copy.visual_parts:
        corners = part.vertices[part.faces].astype(np.float64)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(across, axis=1)
        seen = area > 1e-9
        facing = (across[seen] / area[seen, None] * part.normals[part.faces][seen].mean(axis=1)).sum(axis=1)
        assert facing.min() > 0.5


def test_what_is_round_stays_round_and_copies_differ() -> None:
    copies = [STRETCHED.load(f"{CAN}_stretched_{k}") for k in (1, 2, 3)]
    for copy in copies:
        assert copy.size[0] == pytest.approx(copy.size[1], rel=0.01)
    assert len({tuple(copy.size.round(6)) for copy in copies}) == 3
    box = STRETCHED.load(f"{BOX}_stretched_1").size / ORIGINALS.load(BOX).size
    assert len(set(box.round(4))) == 3


def test_what_a_copy_is_follows_from_seed_and_name_alone() -> None:
    name = f"{BOX}_stretched_2"
    fewer = StretchedObjects(ORIGINALS, copies=2, most=1.4)
    np.testing.assert_array_equal(fewer.load(name).size, STRETCHED.load(name).size)
    other = StretchedObjects(ORIGINALS, copies=3, most=1.4, seed=1)
    assert not np.allclose(other.load(name).size, STRETCHED.load(name).size)
    prints = {own.fingerprint for own in (fewer, other, STRETCHED, StretchedObjects(ORIGINALS, 3, 1.5))}
    assert len(prints) == 4


def test_names_and_values_that_cannot_be_are_refused() -> None:
    for name in (f"{BOX}_stretched_4", f"{BOX}_stretched_0", "nothing_stretched_1", "nothing"):
        with pytest.raises(InputError, match="no object"):
            STRETCHED.load(name)
    with pytest.raises(InputError, match="copies=-1"):
        StretchedObjects(ORIGINALS, copies=-1, most=1.4)
    for most in (0.9, float("nan"), float("inf")):
        with pytest.raises(InputError, match="most="):
            StretchedObjects(ORIGINALS, copies=1, most=most)
