"""The patch cache: derived, deletable at any moment, bounded, never out of date."""

import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_scenes import BoxRenderer, make_scene

from preshape.data.scene import Scene
from preshape.data.view_cache import ViewCache
from preshape.data.view_cache_files import CLOUD_BYTES, TYPICAL_BYTES
from preshape.errors import InputError
from preshape.perception.object_view import ObjectCloud, ObjectView, object_view
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, segment


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


def are_equal(one: ObjectView, other: ObjectView) -> bool:
    return np.array_equal(one.channels, other.channels) and same_cloud(one.cloud, other.cloud)


def same_cloud(one: ObjectCloud, other: ObjectCloud) -> bool:
    names = ("points", "table", "T_camera_box")
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def test_a_patch_is_rendered_once(tmp_path: Path, renderer: CountingRenderer) -> None:
    scenes = [make_scene(0), make_scene(1)]
    cache = ViewCache(tmp_path, renderer)
    cache.fill(scenes)
    cache.fill(scenes)
    first = cache[scenes[0]]
    assert renderer.calls == 2
    again = ViewCache(tmp_path, renderer)[scenes[0]]
    assert renderer.calls == 2
    assert are_equal(first, again)


def test_what_is_kept_is_the_patch_in_half_precision(tmp_path: Path, renderer: CountingRenderer) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer)
    observation = renderer(scene)
    view = object_view(observation, segment(observation, SegmentationSettings()))
    halves = replace(view, channels=view.channels.astype(np.float16))
    assert are_equal(cache[scene], halves)  # made now
    assert are_equal(cache[scene], halves)  # from its file


def test_a_cloud_is_read_without_its_patch(tmp_path: Path, renderer: CountingRenderer) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer)
    whole = cache[scene]
    path = cache.path(scene)
    path.write_bytes(path.read_bytes()[:CLOUD_BYTES])
    assert same_cloud(cache.cloud(scene), whole.cloud)
    assert renderer.calls == 1
    path.write_bytes(path.read_bytes()[: CLOUD_BYTES - 1])
    assert same_cloud(cache.cloud(scene), whole.cloud)
    assert renderer.calls == 2


def damaged(content: bytes) -> dict[str, bytes]:
    content = content or bytes(10_000)
    return {
        "emptied": b"",
        "cut off": content[:1000],
        "cut off after the cloud": content[:CLOUD_BYTES],
        "altered cloud": content[:5000] + bytes([content[5000] ^ 1]) + content[5001:],
        "altered patch": content[:-5000] + bytes([content[-5000] ^ 1]) + content[-4999:],
    }


@pytest.mark.parametrize("damage", [*damaged(b""), "deleted", "folder deleted"])
def test_a_file_that_is_damaged_or_gone_is_made_again(
    tmp_path: Path, renderer: CountingRenderer, damage: str
) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer)
    patch = cache[scene]
    path = cache.path(scene)
    content = path.read_bytes()
    if damage == "folder deleted":
        shutil.rmtree(tmp_path)
    elif damage == "deleted":
        path.unlink()
    else:
        path.write_bytes(damaged(content)[damage])
    assert are_equal(cache[scene], patch)
    assert renderer.calls == 2
    assert path.read_bytes() == content
    assert files(tmp_path) == [path]


def test_deleting_the_folder_during_a_filling_does_no_harm(tmp_path: Path) -> None:
    class Deleting(BoxRenderer):
        def __call__(self, scene: Scene) -> Observation:
            shutil.rmtree(tmp_path / "cache", ignore_errors=True)
            return super().__call__(scene)

    scenes = [make_scene(number) for number in range(3)]
    cache = ViewCache(tmp_path / "cache", Deleting())
    cache.fill(scenes)
    assert files(tmp_path)[0] in [cache.path(scene) for scene in scenes]
    assert len(files(tmp_path)) == 1


def test_an_interrupted_filling_goes_on(tmp_path: Path, renderer: CountingRenderer) -> None:
    def stops(cache: ViewCache, scenes: list[Scene]) -> Iterator[Scene]:
        for scene in scenes[:2]:
            cache.make(scene)
            yield scene
        raise KeyboardInterrupt

    scenes = [make_scene(number) for number in range(4)]
    with pytest.raises(KeyboardInterrupt):
        ViewCache(tmp_path, renderer, maker=stops).fill(scenes)
    assert len(files(tmp_path)) == 2
    ViewCache(tmp_path, renderer).fill(scenes)
    assert renderer.calls == 4


def test_the_least_recently_used_go_when_the_bound_is_reached(
    tmp_path: Path, renderer: CountingRenderer
) -> None:
    scenes = [make_scene(number) for number in range(9)]
    size = largest_file(tmp_path / "probe", renderer, scenes)
    bound = 5.5 * size
    cache = ViewCache(tmp_path / "cache", renderer, max_gigabytes=bound / 1e9)
    for age, scene in enumerate(scenes):
        cache.make(scene)
        os.utime(cache.path(scene), (age, age))
        if age == 3:
            cache[scenes[0]]  # used again
        assert sum(path.stat().st_size for path in files(tmp_path / "cache")) <= bound
    kept = [number for number, scene in enumerate(scenes) if cache.path(scene).exists()]
    assert {0, 7, 8} <= set(kept)
    assert 1 not in kept


def largest_file(folder: Path, renderer: CountingRenderer, scenes: list[Scene]) -> int:
    """Bytes of the largest patch."""
    cache = ViewCache(folder, renderer)
    for scene in scenes:
        cache.make(scene)
    return max(path.stat().st_size for path in files(folder))


def test_more_scenes_than_the_cache_may_hold_are_refused(tmp_path: Path, renderer: CountingRenderer) -> None:
    cache = ViewCache(tmp_path, renderer, max_gigabytes=1.5 * TYPICAL_BYTES / 1e9)
    with pytest.raises(InputError, match="2 scenes"):
        cache.fill([make_scene(0), make_scene(1)])
    assert renderer.calls == 0


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
    segmentation = SegmentationSettings(min_height_m=0.01)
    paths = {ViewCache(tmp_path, CountingRenderer()).path(one) for one in scenes}
    paths.add(ViewCache(tmp_path, CountingRenderer("boxes 2")).path(scene))
    paths.add(ViewCache(tmp_path, CountingRenderer(), segmentation=segmentation).path(scene))
    assert len(paths) == 7
    assert ViewCache(tmp_path, CountingRenderer()).path(make_scene(0)) in paths
