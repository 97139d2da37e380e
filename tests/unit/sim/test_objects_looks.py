"""Every grocery item has a look of its own, small, the same every time, and readable on all sides."""

import numpy as np
import pytest
from PIL import Image

from sim.objects.grocery import FAMILIES, GROCERY_ITEMS, GROCERY_LOOKS, GrocerySet
from sim.objects.looks.artwork import LONGER_SIDE_PX
from sim.objects.looks.designs import STYLES
from sim.objects.looks.dressing import dressed
from sim.objects.looks.lettering import FONTS, write
from sim.objects.looks.pictograms import read_pictograms
from sim.objects.object_model import VisualPart

GROCERY = GrocerySet()
SIZE = (0.06, 0.12, 0.16)
ONE_OF_EACH = {item.family: name for name, item in GROCERY_ITEMS.items()}


def printed_part(name: str) -> VisualPart:
    (part,) = (part for part in GROCERY.load(name).visual_parts if part.texture is not None)
    return part


def test_the_two_tables_hold_the_same_items() -> None:
    assert set(GROCERY_LOOKS) == set(GROCERY_ITEMS)


def test_the_wording_is_the_name() -> None:
    for name, look in GROCERY_LOOKS.items():
        assert f"{look.brand} {look.product}".strip().lower() == name.replace("_", " ")


def test_designs_letters_and_pictures_exist_and_are_used() -> None:
    looks = [look for look in GROCERY_LOOKS.values() if look.style]
    assert {look.style for look in looks} == {*STYLES, "rings"}
    assert {look.letters for look in looks} - {""} == set(FONTS)
    assert {look.picture for look in looks} - {""} <= set(read_pictograms())


def test_no_two_prints_are_alike_and_all_are_small() -> None:
    prints = [printed_part(name).texture for name, look in GROCERY_LOOKS.items() if look.style]
    assert max(max(texture.shape) for texture in prints if texture is not None) <= LONGER_SIDE_PX
    assert len({texture.tobytes() for texture in prints if texture is not None}) == len(prints) > 115


@pytest.mark.parametrize(("family", "name"), sorted(ONE_OF_EACH.items()))
def test_dressing_is_repeatable_and_stays_on_the_picture(family: str, name: str) -> None:
    solid, look = FAMILIES[family].solid(SIZE), GROCERY_LOOKS[name]
    once, again = dressed(solid, SIZE, family, look), dressed(solid, SIZE, family, look)
    for part, other in zip(once, again, strict=True):
        np.testing.assert_array_equal(part.vertices, other.vertices)
        if part.texture is not None and part.uvs is not None:
            np.testing.assert_array_equal(part.texture, other.texture)
            assert part.uvs.min() > -1e-5
            assert part.uvs.max() < 1 + 1e-5


@pytest.mark.parametrize(("name", "axis"), [("canon_ack_e10_box", 0), ("pepto_bismol", 0), ("dove_pink", 2)])
def test_print_is_not_mirrored_on_either_side(name: str, axis: int) -> None:
    """Seen from outside, u grows to the right and v upwards, so their cross product points outwards."""
    part = printed_part(name)
    assert part.uvs is not None
    corners, uvs = part.vertices[part.faces], part.uvs[part.faces]
    edges, steps = corners[:, 1:] - corners[:, :1], uvs[:, 1:] - uvs[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    turn = steps[:, 0, 0] * steps[:, 1, 1] - steps[:, 0, 1] * steps[:, 1, 0]
    broad = np.abs(normals[:, axis]) > 0.9 * np.linalg.norm(normals, axis=1)
    top = axis == 2 or np.abs(normals[:, 2]) < 0.1 * np.linalg.norm(normals, axis=1)
    assert (broad & top).sum() >= 4
    assert (turn[broad & top] > 0).all()


def test_text_fills_its_box_and_keeps_to_it() -> None:
    for text in ("a", "nature valley", "soft baked oatmeal squares cinnamon brown sugar"):
        paper = Image.new("L", (200, 100))
        write(picture := paper.convert("RGB"), text, (20, 10, 180, 90), "sans", "#ffffff")
        rows, columns = np.nonzero(np.asarray(picture).max(axis=2) > 64)
        assert 10 <= rows.min() < rows.max() < 90
        assert 20 <= columns.min() < columns.max() < 180
        assert (np.ptp(columns) > 100) or (np.ptp(rows) > 40)
