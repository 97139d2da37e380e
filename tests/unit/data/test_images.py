"""The patch cache: derived, deletable, never out of date."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_scenes import BoxRenderer, make_scene

from preshape.data.images import PatchCache
from preshape.data.scene import Scene
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings


class CountingRenderer(BoxRenderer):
    """Counts how often it is asked."""

    def __init__(self, fingerprint: str = "boxes 1") -> None:
        self.fingerprint = fingerprint
        self.calls = 0

    def __call__(self, scene: Scene) -> Observation:
        self.calls += 1
        return super().__call__(scene)


@pytest.fixture
def renderer() -> CountingRenderer:
    return CountingRenderer()


def test_a_patch_is_rendered_once(tmp_path: Path, renderer: CountingRenderer) -> None:
    scenes = [make_scene(0), make_scene(1)]
    cache = PatchCache(tmp_path, renderer)
    cache.fill(scenes)
    cache.fill(scenes)
    first = np.array(cache[scenes[0]])
    assert renderer.calls == 2
    again = PatchCache(tmp_path, renderer)[scenes[0]]
    assert renderer.calls == 2
    assert np.array_equal(first, again)


def test_the_object_is_in_the_middle_of_its_patch(tmp_path: Path, renderer: CountingRenderer) -> None:
    patch = PatchCache(tmp_path, renderer)[make_scene(0)]
    red, green = patch[0, 200, 200], patch[1, 200, 200]
    assert (red, green) == pytest.approx((200 / 255, 40 / 255), abs=1e-3)


def test_a_damaged_or_deleted_file_is_made_again(tmp_path: Path, renderer: CountingRenderer) -> None:
    scene, cache = make_scene(0), PatchCache(tmp_path, renderer)
    patch = np.array(cache[scene])
    cache.path(scene).write_bytes(cache.path(scene).read_bytes()[:1000])
    assert np.array_equal(cache[scene], patch)
    cache.path(scene).unlink()
    assert np.array_equal(cache[scene], patch)
    assert renderer.calls == 3
    assert list(tmp_path.rglob("*.npy")) == [cache.path(scene)]


def test_the_name_follows_everything_that_the_patch_depends_on(tmp_path: Path) -> None:
    scene = make_scene(0)
    T_moved = scene.T_world_object.copy()
    T_moved[0, 3] = np.nextafter(T_moved[0, 3], 1)
    scenes = [
        scene,
        replace(scene, T_world_object=T_moved),
        replace(scene, seed=7),
        replace(scene, object_id="box_1"),
        replace(scene, camera=replace(scene.camera, fx=300.0)),
    ]
    paths = {PatchCache(tmp_path, CountingRenderer()).path(one) for one in scenes}
    paths.add(PatchCache(tmp_path, CountingRenderer("boxes 2")).path(scene))
    paths.add(PatchCache(tmp_path, CountingRenderer(), SegmentationSettings(min_height_m=0.01)).path(scene))
    assert len(paths) == 7
    assert PatchCache(tmp_path, CountingRenderer()).path(make_scene(0)) in paths
