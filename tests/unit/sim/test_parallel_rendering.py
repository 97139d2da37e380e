"""Worker processes make the same views as one process, whatever else fills the cache."""

from pathlib import Path

import pytest
from synthetic_scenes import BoxRenderer, make_scene

from preshape.data.scene import Scene
from preshape.data.view_cache import ViewCache
from preshape.errors import InputError
from preshape.perception.observation import Observation
from sim import parallel_rendering
from sim.parallel_rendering import ParallelRendering

SCENES = [make_scene(number) for number in range(6)]


@pytest.fixture(autouse=True)
def _workers_for_few_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel_rendering, "SCENES_PER_WORKER", 1)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*.*")}


@pytest.mark.parametrize("with_patches", [True, False])
def test_parallel_equals_serial(tmp_path: Path, with_patches: bool) -> None:
    ViewCache(tmp_path / "serial", BoxRenderer()).fill(SCENES, with_patches=with_patches)
    cache = ViewCache(tmp_path / "parallel", BoxRenderer(), maker=ParallelRendering(workers=2))
    cache.make(SCENES[0], with_patch=with_patches)
    kept = cache.path(SCENES[0], "cloud").stat().st_ino
    cache.fill(SCENES, with_patches=with_patches)
    assert contents(tmp_path / "parallel") == contents(tmp_path / "serial")
    assert len(contents(tmp_path / "serial")) == len(SCENES) * (2 if with_patches else 1)
    assert cache.path(SCENES[0], "cloud").stat().st_ino == kept  # what is there is not made again


class EmptyTable(BoxRenderer):
    """Sees the table, but no object."""

    def __call__(self, scene: Scene) -> Observation:
        pose = scene.T_world_object.copy()
        pose[2, 3] = -5.0
        return super().__call__(Scene(scene.scene_id, scene.object_id, pose, scene.camera, scene.seed))


def test_bad_input_comes_out_of_the_workers(tmp_path: Path) -> None:
    cache = ViewCache(tmp_path, EmptyTable(), maker=ParallelRendering(workers=2))
    with pytest.raises(InputError, match="No object stands on the table"):
        cache.fill(SCENES, with_patches=True)
