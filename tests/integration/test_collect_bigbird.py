"""BigBIRD's own folders are collected from as a user would do it."""

from pathlib import Path

import pytest
from ready_python import ReadyPython
from synthetic_bigbird import box_mesh, write_meshes
from test_collect import run_collect

from preshape.data.tables import read_data_set
from preshape.grasps.space import GraspSpace


@pytest.mark.slow
def test_scans_are_collected_from(
    ready_python: ReadyPython, tmp_path: Path, allegro_space: GraspSpace
) -> None:
    write_meshes(tmp_path / "bigbird" / "red_box" / "processed", box_mesh())
    (tmp_path / "bigbird" / "listerine_green").mkdir()
    wanted = ("collect.trials=1", "collect.workers=1", "collect.block=1")
    scans = ("objects=bigbird", f"objects.root={tmp_path / 'bigbird'}")
    done = run_collect(ready_python, tmp_path, *scans, *wanted)
    assert done.returncode == 0, done.stderr
    assert (done.stdout + done.stderr).count("listerine_green") == 1
    scenes, trials = read_data_set(tmp_path / "table", allegro_space)
    assert {scene.object_id for scene in scenes.scenes} == {"red_box"}
    assert len(trials.executed) >= 1
