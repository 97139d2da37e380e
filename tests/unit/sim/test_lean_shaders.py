"""The lean shaders draw the same picture as SAPIEN's own, in less time."""

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from preshape.data.scene import Scene
from sim import camera, lean_shaders
from sim.camera import camera_looking_at
from sim.objects.grocery import GrocerySet
from sim.scene_renderer import SapienSceneRenderer
from sim.table import TableSettings

RENDERER = SapienSceneRenderer(GrocerySet(), TableSettings())


def scene() -> Scene:
    view = camera_looking_at([0.8, -0.5, 1.0], [0.8, 0, 0.65], 320, 240, 262)
    pose = np.eye(4)
    pose[:3, 3] = 0.8, 0.0, RENDERER.table.top_m + RENDERER.objects.load("spam").standing_height_m
    return Scene(1, "spam", pose, view, 3)


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setattr(lean_shaders, "project_root", lambda: tmp_path)
    return tmp_path


def test_the_picture_is_the_same_to_the_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    lean = RENDERER(scene())
    monkeypatch.setattr(camera, "lean_shaders", lambda: str(lean_shaders.SHADERS / lean_shaders.PACK))
    own = replace(RENDERER)(scene())
    np.testing.assert_array_equal(lean.rgb, own.rgb)
    np.testing.assert_array_equal(lean.depth, own.depth)
    np.testing.assert_array_equal(lean.mask, own.mask)
    assert lean.rgb.std() > 10


def test_they_are_made_again_when_they_were_deleted(root: Path) -> None:
    first = RENDERER(scene())
    folder = Path(lean_shaders.lean_shaders())
    assert folder.is_relative_to(root)
    shutil.rmtree(root / ".cache")
    np.testing.assert_array_equal(replace(RENDERER)(scene()).rgb, first.rgb)
    assert Path(lean_shaders.lean_shaders()) == folder
    assert not [path for path in folder.parents[1].iterdir() if path != folder.parent]


def test_other_shaders_of_sapien_are_used_as_they_are(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(lean_shaders.EDITS, "default/deferred.frag", (("no such text", ""),))
    assert Path(lean_shaders.lean_shaders()) == lean_shaders.SHADERS / lean_shaders.PACK
