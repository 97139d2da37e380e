"""A sheet shows every object of a set once, whole, on an even ground."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from preshape.errors import InputError
from sim.object_portraits import PortraitSettings, SheetFile, SheetSettings, contact_sheet, portrait
from sim.objects.mesh_folder import MeshFolder

GROUND = (1, 2, 3)
SETTINGS = PortraitSettings(40, 50, background=GROUND)


@pytest.fixture
def balls(tmp_path_factory: pytest.TempPathFactory) -> MeshFolder:
    folder = tmp_path_factory.mktemp("balls")
    for name, radius in (("large", 0.1), ("medium", 0.05), ("small", 0.01)):
        trimesh.creation.icosphere(subdivisions=2, radius=radius).export(folder / f"{name}.stl")
    return MeshFolder(folder, tmp_path_factory.mktemp("cache"))


def test_objects_of_any_size_fill_their_place(balls: MeshFolder) -> None:
    pictures = [portrait(balls.load(name), SETTINGS) for name in balls.names]
    shares = [(picture != GROUND).any(axis=2).mean() for picture in pictures]
    assert min(shares) > 0.1
    assert max(shares) - min(shares) < 0.02
    for picture in pictures:
        assert (picture[[0, -1]] == GROUND).all()
        assert (picture[:, [0, -1]] == GROUND).all()


def test_the_sheet_has_a_place_for_each(balls: MeshFolder) -> None:
    page = np.asarray(contact_sheet(balls, SETTINGS, SheetSettings(columns=2, caption_px=10, font_px=6.0)))
    assert page.shape == (120, 80, 3)
    places = [page[row : row + 50, column : column + 40] for row in (0, 60) for column in (0, 40)]
    assert [bool((place == GROUND).all(axis=2).any()) for place in places] == [True, True, True, False]


@pytest.mark.parametrize(("suffix", "kind"), [(".webp", "WEBP"), (".png", "PNG"), (".jpg", "JPEG")])
def test_a_sheet_is_what_its_name_says(suffix: str, kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"sheet{suffix}"
    SheetFile(path, 70).save(Image.new("RGB", (8, 8)))
    with Image.open(path) as found:
        assert found.format == kind


@pytest.mark.parametrize("name", ["sheet", "sheet.gif"])
def test_other_kinds_of_pictures_are_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="known format"):
        SheetFile(tmp_path / name, 70)
    assert not list(tmp_path.iterdir())
