"""The view cache: derived, deletable at any moment, bounded, never out of date."""

import os
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from synthetic_scenes import BoxRenderer, make_scene

from preshape.data.scene import Scene
from preshape.data.view_cache import Part, ViewCache
from preshape.data.view_cache_files import CLOUD_BYTES, TYPICAL_PATCH_BYTES
from preshape.errors import InputError
from preshape.perception.object_view import ObjectCloud, object_cloud, object_patch
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


def same_cloud(one: ObjectCloud, other: ObjectCloud) -> bool:
    names = ("points", "table", "T_camera_box")
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def test_a_view_is_rendered_once(tmp_path: Path, renderer: CountingRenderer) -> None:
    scenes = [make_scene(0), make_scene(1)]
    cache = ViewCache(tmp_path, renderer)
    cache.fill(scenes, with_patches=True)
    cache.fill(scenes, with_patches=True)
    cache.fill(scenes, with_patches=False)
    first = cache.patch(scenes[0]), cache.cloud(scenes[0])
    again = ViewCache(tmp_path, renderer)
    assert np.array_equal(again.patch(scenes[0]), first[0])
    assert same_cloud(again.cloud(scenes[0]), first[1])
    assert renderer.calls == 2


def test_what_is_kept_is_the_cloud_and_the_patch_in_half_precision(
    tmp_path: Path, renderer: CountingRenderer
) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer)
    observation = renderer(scene)
    cloud = object_cloud(segment(observation, SegmentationSettings()))
    patch = object_patch(observation, cloud.centre(observation.camera)).astype(np.float16)
    for _ in ("made now", "from its file"):
        assert np.array_equal(cache.patch(scene), patch)
        assert same_cloud(cache.cloud(scene), cloud)


def test_clouds_alone_take_little_space(tmp_path: Path, renderer: CountingRenderer) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer, max_gigabytes=1.5 * CLOUD_BYTES / 1e9)
    cache.fill([scene], with_patches=False)
    assert [path.stat().st_size for path in files(tmp_path)] == [CLOUD_BYTES]
    assert cache.holds(scene, with_patch=False)
    assert not cache.holds(scene, with_patch=True)
    with pytest.raises(InputError, match="max_gigabytes"):
        cache.fill([scene], with_patches=True)


def damaged(content: bytes) -> dict[str, bytes]:
    content = content or bytes(10_000)
    return {
        "emptied": b"",
        "cut off": content[:1000],
        "without its last byte": content[:-1],
        "altered": content[:5000] + bytes([content[5000] ^ 1]) + content[5001:],
        "altered checksum": bytes([content[0] ^ 1]) + content[1:],
    }


@pytest.mark.parametrize("part", get_args(Part))
@pytest.mark.parametrize("damage", [*damaged(b""), "deleted", "folder deleted"])
def test_a_file_that_is_damaged_or_gone_is_made_again(
    tmp_path: Path, renderer: CountingRenderer, damage: str, part: Part
) -> None:
    scene, cache = make_scene(0), ViewCache(tmp_path, renderer)
    cache.make(scene, with_patch=True)
    path = cache.path(scene, part)
    content = path.read_bytes()
    if damage == "folder deleted":
        shutil.rmtree(tmp_path)
    elif damage == "deleted":
        path.unlink()
    else:
        path.write_bytes(damaged(content)[damage])
    made = {"cloud": cache.cloud, "patch": cache.patch}[part](scene)
    assert renderer.calls == 2
    assert path.read_bytes() == content
    assert made is not None


def test_deleting_the_folder_during_a_filling_does_no_harm(tmp_path: Path) -> None:
    class Deleting(BoxRenderer):
        def __call__(self, scene: Scene) -> Observation:
            shutil.rmtree(tmp_path / "cache", ignore_errors=True)
            return super().__call__(scene)

    scenes = [make_scene(number) for number in range(3)]
    cache = ViewCache(tmp_path / "cache", Deleting())
    cache.fill(scenes, with_patches=True)
    kept = [cache.path(scene, part) for scene in scenes for part in get_args(Part)]
    assert len(files(tmp_path)) == 2
    assert set(files(tmp_path)) <= set(kept)


def test_an_interrupted_filling_goes_on(tmp_path: Path, renderer: CountingRenderer) -> None:
    def stops(cache: ViewCache, scenes: Sequence[Scene], *, with_patches: bool) -> Iterator[Scene]:
        for scene in scenes[:2]:
            cache.make(scene, with_patch=with_patches)
            yield scene
        raise KeyboardInterrupt

    scenes = [make_scene(number) for number in range(4)]
    with pytest.raises(KeyboardInterrupt):
        ViewCache(tmp_path, renderer, maker=stops).fill(scenes, with_patches=True)
    assert len(files(tmp_path)) == 4
    ViewCache(tmp_path, renderer).fill(scenes, with_patches=True)
    assert renderer.calls == 4


def test_the_least_recently_used_go_when_the_bound_is_reached(
    tmp_path: Path, renderer: CountingRenderer
) -> None:
    scenes = [make_scene(number) for number in range(9)]
    size = largest_file(tmp_path / "probe", renderer, scenes)
    bound = 5.5 * size
    cache = ViewCache(tmp_path / "cache", renderer, max_gigabytes=bound / 1e9)
    for age, scene in enumerate(scenes):
        cache.make(scene, with_patch=True)
        for part in get_args(Part):
            os.utime(cache.path(scene, part), (age, age))
        if age == 3:
            cache.patch(scenes[0])  # used again
        assert sum(path.stat().st_size for path in files(tmp_path / "cache")) <= bound
    kept = [number for number, scene in enumerate(scenes) if cache.path(scene, "patch").exists()]
    assert {0, 7, 8} <= set(kept)
    assert 1 not in kept


def largest_file(folder: Path, renderer: CountingRenderer, scenes: list[Scene]) -> int:
    """Bytes of the largest view."""
    cache = ViewCache(folder, renderer)
    for scene in scenes:
        cache.make(scene, with_patch=True)
    return max(path.stat().st_size for path in files(folder)) + CLOUD_BYTES


def test_more_scenes_than_the_cache_may_hold_are_refused(tmp_path: Path, renderer: CountingRenderer) -> None:
    cache = ViewCache(tmp_path, renderer, max_gigabytes=1.5 * TYPICAL_PATCH_BYTES / 1e9)
    with pytest.raises(InputError, match="2 scenes"):
        cache.fill([make_scene(0), make_scene(1)], with_patches=True)
    assert renderer.calls == 0


def test_the_name_follows_everything_that_the_view_depends_on(tmp_path: Path) -> None:
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
    paths = {ViewCache(tmp_path, CountingRenderer()).path(one, "patch") for one in scenes}
    paths.add(ViewCache(tmp_path, CountingRenderer("boxes 2")).path(scene, "patch"))
    paths.add(ViewCache(tmp_path, CountingRenderer(), segmentation=segmentation).path(scene, "patch"))
    assert len(paths) == 7
    assert ViewCache(tmp_path, CountingRenderer()).path(make_scene(0), "patch") in paths
    assert ViewCache(tmp_path, CountingRenderer()).path(replace(scene, scene_id=5), "patch") in paths
