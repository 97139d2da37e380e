"""`python sim/collect.py` as a user runs it: what it writes, and that nothing but the seed decides it."""

import shutil
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from ready_python import ReadyPython

from preshape.data.tables import read_data_set
from preshape.files import read_json
from preshape.grasps.space import GraspSpace
from preshape.paths import project_root
from sim.crashes import differing_rows

WANTED = ("collect.trials=8", "collect.workers=1", "collect.block=1")


def collect_command(place: Path, *overrides: str) -> list[str]:
    return [
        *(sys.executable, str(project_root() / "sim" / "collect.py"), *overrides),
        *(f"paths.{name}={place / name}" for name in ("cache", "outputs")),
        f"collect.output={place / 'table'}",
    ]


def run_collect(python: ReadyPython, place: Path, *overrides: str) -> "subprocess.CompletedProcess[str]":
    _, script, *settings = collect_command(place, *overrides)
    return python.run(Path(script), *settings, cwd=place)


@pytest.fixture(scope="module")
def undisturbed(ready_python: ReadyPython, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("undisturbed")
    done = run_collect(ready_python, place, *WANTED)
    assert done.returncode == 0, done.stderr
    assert "starting 1 workers" in done.stdout
    assert str(place / "table") in done.stdout.splitlines()[-1]
    return place


def differences(one: Path, other: Path, space: GraspSpace) -> int:
    tables = [read_data_set(place / "table", space) for place in (one, other)]
    assert [scene.seed for scene in tables[0][0].scenes] == [scene.seed for scene in tables[1][0].scenes]
    return differing_rows(tables[0][1], tables[1][1])


def test_the_table_holds_what_was_asked_for(undisturbed: Path, allegro_space: GraspSpace) -> None:
    scenes, trials = read_data_set(undisturbed / "table", allegro_space)
    assert len(trials.executed) >= 8
    assert set(trials.scene_ids) <= {scene.scene_id for scene in scenes.scenes}
    assert set(trials.rows["planner"]) == {"heuristic", "exploration"}
    effort = read_json(undisturbed / "outputs" / "collect" / "lbr4_allegro_grocery" / "collection.json")
    assert effort["executed"] >= 8
    assert effort["executed_per_hour"] == pytest.approx(3600 * effort["executed"] / effort["seconds"])
    assert [path.name for path in (undisturbed / "outputs" / "collect").iterdir()] == ["lbr4_allegro_grocery"]


def test_a_killed_and_damaged_run_ends_with_the_table_of_an_undisturbed_one(
    ready_python: ReadyPython, undisturbed: Path, allegro_space: GraspSpace, tmp_path: Path
) -> None:
    with subprocess.Popen(collect_command(tmp_path, *WANTED), cwd=tmp_path) as killed:
        while not (finished := finished_scenes(tmp_path)) and killed.poll() is None:
            time.sleep(0.1)
        workers = psutil.Process(killed.pid).children(recursive=True)
        killed.kill()
    assert killed.returncode < 0
    assert psutil.wait_procs(workers, timeout=10)[1] == []
    path, content = finished[0]
    path.write_bytes(content.replace(b'"heuristic"', b'"heretical"', 1))
    done = run_collect(ready_python, tmp_path, *WANTED)
    assert done.returncode == 0, done.stderr
    assert f"{path}: 1 damaged" in done.stdout
    assert differences(undisturbed, tmp_path, allegro_space) == 0


def finished_scenes(place: Path) -> list[tuple[Path, bytes]]:
    files = sorted((place / "cache" / "collect").glob("*/*.jsonl"))
    return [(path, content) for path in files if b'"heuristic"' in (content := path.read_bytes())]


def test_shards_end_with_the_table_of_one_process(
    ready_python: ReadyPython, undisturbed: Path, allegro_space: GraspSpace, tmp_path: Path
) -> None:
    shards = ("--multirun", "hydra/launcher=submitit_local", "shard=0,1")
    done = run_collect(ready_python, tmp_path, *shards, *WANTED)
    assert done.returncode == 0, done.stderr
    assert differences(undisturbed, tmp_path, allegro_space) == 0
    owners = {content.split(b"}")[0] for _, content in finished_scenes(tmp_path)}
    assert len({owner.partition(b" ")[2] for owner in owners}) == 2


def test_a_finished_run_only_writes_its_table_again(
    ready_python: ReadyPython, undisturbed: Path, tmp_path: Path
) -> None:
    shutil.copytree(undisturbed / "cache", tmp_path / "cache")
    done = run_collect(ready_python, tmp_path, *WANTED)
    assert done.returncode == 0, done.stderr
    for name in ("trials.parquet", "scenes.parquet"):
        tables = [place / "table" / name for place in (undisturbed, tmp_path)]
        assert tables[0].read_bytes() == tables[1].read_bytes()


@pytest.mark.parametrize("launcher", [(), ("--multirun", "hydra/launcher=submitit_local", "shard=0")])
def test_a_folder_without_objects_is_refused(
    ready_python: ReadyPython, tmp_path: Path, launcher: tuple[str, ...]
) -> None:
    (tmp_path / "empty").mkdir()
    chosen = ("objects=mesh_folder", f"objects.root={tmp_path / 'empty'}")
    done = run_collect(ready_python, tmp_path, *launcher, *chosen)
    assert done.returncode == 2
    assert str(tmp_path / "empty") in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "table").exists()
