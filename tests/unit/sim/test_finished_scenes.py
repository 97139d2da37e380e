"""A finished scene comes back to the bit, and one that is damaged does not come back at all."""

import os
import resource
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from synthetic_finished_scenes import finished_scene

from preshape.data.trial_table import SCALARS, THETAS
from preshape.errors import InputError
from sim.finished_scenes import FinishedScene, SceneBlock


def same(one: FinishedScene, other: FinishedScene) -> bool:
    assert one.scene is not None
    assert other.scene is not None
    pairs = [(one.scene.T_world_object, other.scene.T_world_object)]
    pairs += [(one.scene.camera.T_world_camera, other.scene.camera.T_world_camera)]
    for a, b in zip(one.trials, other.trials, strict=True):
        pairs += [(getattr(a, name), getattr(b, name)) for name in THETAS]
        for name in SCALARS:
            np.testing.assert_equal(getattr(a, name), getattr(b, name))
    return one.scene.seed == other.scene.seed and all(a.tobytes() == b.tobytes() for a, b in pairs)


@pytest.fixture
def block(tmp_path: Path) -> Iterator[SceneBlock]:
    block = SceneBlock(tmp_path / "parts" / "scenes.jsonl", range(8))
    assert block.claim()
    for scene_id in (0, 2):
        block.add(finished_scene(scene_id))
    yield block
    block.release()


def test_scenes_come_back_to_the_bit(block: SceneBlock) -> None:
    block.add(FinishedScene(3, None, ()))
    content = block.read()
    assert sorted(content.finished) == [0, 2, 3]
    assert content.finished[3].scene is None
    assert all(same(content.finished[scene_id], finished_scene(scene_id)) for scene_id in (0, 2))
    assert (content.damaged, content.owner.split()[:2]) == (0, ["Process", str(os.getpid())])


def test_wherever_a_file_is_cut_off_its_whole_lines_count(block: SceneBlock) -> None:
    block.release()
    whole = block.path.read_bytes()
    first = whole.index(b"\n", whole.index(b"\n") + 1)
    for size in (len(whole) - 1, len(whole) - 2, len(whole) - 300, first + 1, first + 2):
        block.path.write_bytes(whole[:size])
        content = block.read()
        assert set(content.finished) == ({0, 2} if size == len(whole) - 1 else {0})
        assert content.damaged == (size not in (len(whole) - 1, first + 1))
        assert block.claim()  # and can be gone on with
        block.add(finished_scene(2))
        block.release()
        assert sorted(block.read().finished) == [0, 2]


def test_an_altered_line_does_not_count(block: SceneBlock) -> None:
    whole = block.path.read_bytes()
    for place in range(len(whole) - 3000, len(whole) - 1, 97):
        altered = bytearray(whole)
        altered[place] ^= 1
        block.path.write_bytes(altered)
        content = block.read()
        assert set(content.finished) in ({0}, {2})
        assert content.damaged >= 1


def test_only_one_process_has_a_block(block: SceneBlock) -> None:
    other = SceneBlock(block.path, block.numbers)
    assert not other.claim()
    assert sorted(other.read().finished) == [0, 2]
    block.release()
    assert other.claim()
    other.release()


@contextmanager
def full_disk(size: int) -> Iterator[None]:
    """No file can grow beyond a size (bytes)."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_is_refused_and_costs_nothing_that_is_finished(block: SceneBlock) -> None:
    with full_disk(block.path.stat().st_size + 100), pytest.raises(InputError, match="File too large"):
        block.add(finished_scene(4))
    block.release()
    assert sorted(block.read().finished) == [0, 2]
    assert block.claim()
    block.add(finished_scene(4))
    assert sorted(block.read().finished) == [0, 2, 4]


@contextmanager
def unprivileged() -> Iterator[None]:
    """Root may write everywhere, so be someone else."""
    user = os.geteuid()
    os.seteuid(65534 if user == 0 else user)
    try:
        yield
    finally:
        os.seteuid(user)


def test_a_read_only_folder_is_refused() -> None:
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        Path(folder).chmod(0o555)
        block = SceneBlock(Path(folder) / "scenes.jsonl", range(8))
        with unprivileged(), pytest.raises(InputError, match="cannot be written: Permission denied"):
            block.claim()
