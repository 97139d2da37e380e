"""`python sim/collect.py` as a user runs it: what it writes, and that nothing but the seed decides it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from preshape.data.tables import read_data_set
from preshape.data.trial_table import THETAS, TrialTable
from preshape.grasps.space import GraspSpace
from preshape.paths import project_root

TIMINGS = ["scene_s", "planning_s", "physics_s", "rendering_s"]


def run_collect(place: Path, *overrides: str) -> "subprocess.CompletedProcess[str]":
    command = [
        *(sys.executable, str(project_root() / "sim" / "collect.py")),
        *(f"paths.{name}={place / name}" for name in ("cache", "outputs")),
        f"collect.output={place / 'table'}",
        *overrides,
    ]
    return subprocess.run(command, cwd=place, capture_output=True, text=True, timeout=280, check=False)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("undisturbed")
    done = run_collect(place, "collect.trials=3", "collect.workers=1")
    assert done.returncode == 0, done.stderr
    assert str(place / "table") in done.stdout.splitlines()[-1]
    return place


def test_the_table_holds_what_was_asked_for(undisturbed: Path, allegro_space: GraspSpace) -> None:
    scenes, trials = read_data_set(undisturbed / "table", allegro_space)
    assert len(trials.executed) >= 3
    assert set(trials.scene_ids) <= {scene.scene_id for scene in scenes.scenes}
    assert set(trials.rows["planner"]) == {"heuristic"}


def test_a_killed_run_ends_with_the_table_of_an_undisturbed_one(
    undisturbed: Path, allegro_space: GraspSpace, tmp_path: Path
) -> None:
    shutil.copytree(undisturbed / "cache", tmp_path / "cache")
    (parts,) = (tmp_path / "cache" / "collect").iterdir()
    finished = sorted(parts.iterdir())
    (finished[0] / "trials.parquet").unlink()  # as if killed before the scene was complete
    shutil.rmtree(finished[-1])
    done = run_collect(tmp_path, "collect.trials=3", "collect.workers=2")
    assert done.returncode == 0, done.stderr
    _, before = read_data_set(undisturbed / "table", allegro_space)
    _, after = read_data_set(tmp_path / "table", allegro_space)
    assert_same_but_for_time(before, after)


def test_a_folder_without_objects_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = run_collect(tmp_path, "objects=mesh_folder", f"objects.root={tmp_path / 'empty'}")
    assert done.returncode == 2
    assert str(tmp_path / "empty") in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "table").exists()


def assert_same_but_for_time(one: TrialTable, other: TrialTable) -> None:
    """Compare all that a seed decides, to the bit."""
    pd.testing.assert_frame_equal(
        one.rows.drop(columns=TIMINGS), other.rows.drop(columns=TIMINGS), check_exact=True
    )
    for name in THETAS:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
