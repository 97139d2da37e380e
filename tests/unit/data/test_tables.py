"""Trial and scene tables: every bit comes back, and nothing else is believed."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from preshape.data import tables
from preshape.data.scene import Scene
from preshape.data.tables import read_data_set, read_scenes, read_trials, write_scenes, write_trials
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import SCALARS, THETAS, SceneTable, TableOrigin, TrialTable
from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.grasps.space import GraspSpace

ORIGIN = TableOrigin(robot="lbr4_allegro", object_set="grocery", camera="kinect")


def make_space(name: str = "allegro_palm14", joints: int = 8) -> GraspSpace:
    return GraspSpace.palm_and_joints(name, {f"joint_{i}": (-0.5, 0.5) for i in range(joints)})


def make_scene(scene_id: int, rng: np.random.Generator) -> Scene:
    camera = Camera(640, 480, *rng.normal(size=4).tolist(), rng.normal(size=(4, 4)))
    return Scene(scene_id, f"object_{scene_id % 2}", rng.normal(size=(4, 4)), camera, seed=2**63 + scene_id)


def make_trial(trial_id: int, rng: np.random.Generator, outcome: TrialOutcome) -> Trial:
    reached = rng.normal(size=14) if outcome.executed else np.full(14, np.nan)
    times = dict(
        zip(("scene_s", "planning_s", "physics_s", "rendering_s"), rng.random(4).tolist(), strict=True)
    )
    return Trial(
        trial_id=trial_id,
        scene_id=trial_id % 3,
        object_id=f"object_{trial_id % 3 % 2}",
        planner="heuristic",
        face=list(Face)[trial_id % 3],
        initial=rng.normal(size=14),
        planned=rng.normal(size=14) * 1e-300,
        reached=reached,
        outcome=outcome,
        lift_height_m=float(rng.normal()),
        success_prob=float("nan"),
        seed=2**64 - 1 - trial_id,
        **dict(times),
    )


@pytest.fixture
def scenes() -> SceneTable:
    rng = np.random.default_rng(0)
    return SceneTable(ORIGIN, tuple(make_scene(i, rng) for i in range(3)))


@pytest.fixture
def trials() -> list[Trial]:
    rng = np.random.default_rng(1)
    outcomes = list(TrialOutcome)
    return [make_trial(i, rng, outcomes[i % len(outcomes)]) for i in range(12)]


@pytest.fixture
def folder(tmp_path: Path, scenes: SceneTable, trials: list[Trial]) -> Path:
    write_scenes(tmp_path / "scenes.parquet", scenes)
    write_trials(tmp_path / "trials.parquet", TrialTable.from_trials(trials, make_space(), ORIGIN))
    return tmp_path


def same_bits(a: object, b: object) -> bool:
    return np.asarray(a).tobytes() == np.asarray(b).tobytes()


def test_scenes_come_back_to_the_bit(folder: Path, scenes: SceneTable) -> None:
    read = read_scenes(folder / "scenes.parquet")
    assert read.origin == scenes.origin
    assert len(read) == len(scenes)
    for old, new in zip(scenes.scenes, read.scenes, strict=True):
        assert (old.scene_id, old.object_id, old.seed) == (new.scene_id, new.object_id, new.seed)
        assert same_bits(old.T_world_object, new.T_world_object)
        assert same_bits(old.camera.T_world_camera, new.camera.T_world_camera)
        assert all(getattr(old.camera, name) == getattr(new.camera, name) for name in tables.CAMERA_COLUMNS)


def test_trials_come_back_to_the_bit(folder: Path, trials: list[Trial]) -> None:
    read = read_trials(folder / "trials.parquet", make_space())
    assert read.origin == ORIGIN
    for old, new in zip(trials, read.to_trials(), strict=True):
        for name in SCALARS:
            before, after = getattr(old, name), getattr(new, name)
            assert type(before) is type(after), name
            assert before == after or same_bits(before, after), name
        assert all(same_bits(getattr(old, name), getattr(new, name)) for name in THETAS)


def test_an_empty_table_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "trials.parquet"
    write_trials(path, TrialTable.from_trials([], make_space(), ORIGIN))
    assert read_trials(path, make_space()).to_trials() == []


def test_only_executed_trials_are_examples(folder: Path, trials: list[Trial]) -> None:
    executed = read_trials(folder / "trials.parquet", make_space()).executed
    wanted = [trial for trial in trials if trial.outcome.executed]
    assert executed.rows["trial_id"].tolist() == [trial.trial_id for trial in wanted]
    assert executed.lifted.tolist() == [trial.outcome is TrialOutcome.LIFTED for trial in wanted]
    assert same_bits(executed.reached, np.array([trial.reached for trial in wanted]))


def edit(path: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    pq.write_table(change(pq.read_table(path)), path)


def with_metadata(old: bytes, new: bytes) -> Callable[[pa.Table], pa.Table]:
    def change(table: pa.Table) -> pa.Table:
        metadata = table.schema.metadata[b"preshape"]
        assert old in metadata
        return table.replace_schema_metadata({b"preshape": metadata.replace(old, new)})

    return change


def with_column(name: str, values: list[object]) -> Callable[[pa.Table], pa.Table]:
    def change(table: pa.Table) -> pa.Table:
        column = pa.array(values * table.num_rows, table.schema.field(name).type)
        return table.set_column(table.column_names.index(name), name, column)

    return change


@pytest.mark.parametrize("name", ["scenes.parquet", "trials.parquet"])
@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda path: path.unlink(), "There is no table"),
        (lambda path: path.write_bytes(path.read_bytes()[:200]), "cannot be read"),
        (lambda path: path.write_bytes(b""), "cannot be read"),
        (lambda path: path.write_text("trial_id,scene_id"), "cannot be read"),
        (lambda path: edit(path, with_metadata(b'"version": ', b'"version": 7')), "version 7"),
        (lambda path: edit(path, lambda t: t.replace_schema_metadata(None)), "not a table of"),
        (lambda path: edit(path, with_metadata(b"camera", b"lens")), "where it comes from|grasp space"),
        (lambda path: edit(path, lambda t: t.drop_columns("seed")), "columns: seed"),
        (lambda path: edit(path, lambda t: t.append_column("more", t["seed"])), "columns: more"),
        (lambda path: edit(path, with_column("seed", [None])), "empty cells: seed"),
        (
            lambda path: edit(path, with_column("scene_id" if "scenes" in path.name else "trial_id", [4])),
            "once",
        ),
    ],
)
def test_damaged_and_foreign_files_are_refused(
    folder: Path, name: str, damage: Callable[[Path], object], message: str
) -> None:
    damage(folder / name)
    with pytest.raises(InputError, match=message):
        read_data_set(folder, make_space())


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (with_column("outcome", ["levitated"]), "'levitated' is no outcome"),
        (with_column("face", ["bottom"]), "'bottom' is no face"),
        (with_column("theta_reached", [[float("nan")] * 14]), "which grasp was reached"),
        (with_column("object_id", ["another"]), "12 trials lack their scene"),
        (with_column("scene_id", [99]), "12 trials lack their scene"),
        (with_metadata(b"grocery", b"toys"), "do not match"),
    ],
)
def test_inconsistent_trials_are_refused(
    folder: Path, damage: Callable[[pa.Table], pa.Table], message: str
) -> None:
    edit(folder / "trials.parquet", damage)
    with pytest.raises(InputError, match=message):
        read_data_set(folder, make_space())


@pytest.mark.parametrize("space", [make_space("other"), make_space(joints=4)])
def test_trials_of_another_grasp_space_are_refused(folder: Path, space: GraspSpace) -> None:
    with pytest.raises(InputError, match="grasp space"):
        read_trials(folder / "trials.parquet", space)


def test_the_limits_of_a_grasp_space_are_not_part_of_its_meaning(folder: Path) -> None:
    space = make_space()
    read_trials(folder / "trials.parquet", replace(space, upper=space.upper + 0.1))


def test_the_data_hash_follows_the_content(folder: Path, scenes: SceneTable) -> None:
    before = tables.data_hash(folder)
    write_scenes(folder / "scenes.parquet", scenes)
    assert tables.data_hash(folder) == before
    write_scenes(folder / "scenes.parquet", SceneTable(ORIGIN, scenes.scenes[:2]))
    assert tables.data_hash(folder) != before


def test_the_hash_of_a_table_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError):
        tables.data_hash(tmp_path / "nothing")
