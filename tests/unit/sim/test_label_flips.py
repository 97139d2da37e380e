"""Trials are drawn evenly, repeated under other settings, and compared with what was recorded."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from PIL import Image
from ready_python import ReadyPython
from synthetic_scenes import ORIGIN, allegro_space, make_scene, make_trial

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.scene import Scene
from preshape.data.tables import write_data_set
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.files import read_json
from preshape.geometry.pose import invert_pose, make_pose
from preshape.paths import project_root
from sim.label_flips import RepeatedTrial, compared, count_flips, from_row, sample_trials, to_row
from sim.laboratory import Laboratory
from sim.trial import PlannedGrasp
from sim.variants import compose_variants

LIFTED, MISSED, BLOCKED = TrialOutcome.LIFTED, TrialOutcome.MISSED, TrialOutcome.BLOCKED
NAN = float("nan")


@pytest.fixture(scope="module")
def table() -> TrialTable:
    trials = [make_trial(number, make_scene(number // 3)) for number in range(90)]
    return TrialTable.from_trials(trials, allegro_space(), ORIGIN)


@pytest.mark.parametrize("n", [2, 9, 40])
def test_samples_are_half_lifted_and_executed(table: TrialTable, n: int) -> None:
    drawn = sample_trials(table, n, seed=3)
    labels = dict(zip(table.rows["trial_id"], table.lifted, strict=True))
    outcomes = dict(zip(table.rows["trial_id"], table.rows["outcome"], strict=True))
    assert drawn == sorted(set(drawn))
    assert len(drawn) == n
    assert all(TrialOutcome(outcomes[number]).executed for number in drawn)
    assert sum(labels[number] for number in drawn) == n // 2
    assert drawn == sample_trials(table, n, seed=3)
    assert set(drawn) <= set(sample_trials(table, n + 8, seed=3))


def test_a_sample_takes_what_one_label_lacks_from_the_other(table: TrialTable) -> None:
    everything = sample_trials(table, len(table.executed), seed=0)
    assert everything == sorted(table.executed.rows["trial_id"])
    with pytest.raises(InputError, match="fewer than"):
        sample_trials(table, len(table), seed=0)


def test_flips_are_counted_in_both_directions() -> None:
    trials = [
        RepeatedTrial(0, LIFTED, LIFTED, NAN, identical=True),
        RepeatedTrial(1, LIFTED, MISSED, NAN, identical=False),
        RepeatedTrial(2, MISSED, LIFTED, NAN, identical=False),
        RepeatedTrial(3, MISSED, BLOCKED, NAN, identical=False),
        RepeatedTrial(4, LIFTED, LIFTED, 0.2, identical=False),
    ]
    flips = count_flips(["a=1"], trials)
    assert (flips.n, flips.flips, flips.identical, flips.not_executed) == (5, 3, 1, 1)
    assert (flips.lifted_before, flips.lifted_after) == (3, 2)
    assert flips.low < flips.share < flips.high
    assert flips.soft_labels == {"lifted": {"0.20": 1}, "not_lifted": {"0.20": 0}}
    assert [repr(from_row(to_row(trial))) for trial in trials] == [repr(trial) for trial in trials]


def test_what_the_simulator_failed_at_is_unstable() -> None:
    trial = make_trial(0, make_scene(0))
    assert compared(trial, trial).identical
    assert not compared(trial, replace(trial, lift_height_m=0.1)).identical
    assert compared(trial, None).repeated is TrialOutcome.UNSTABLE


def test_variants_change_only_what_they_name() -> None:
    half = "_target_:sim.reweighed_objects.ReweighedObjects,objects:${objects.set},factor:0.5"
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        changes = {
            "same": [],
            "light": [f"laboratory.runner.objects={{{half}}}"],
            "slow": ["robot.motion.lift_speed_m_s=0.05"],
        }
        same, light, slow = compose_variants("sensitivity", ["objects.set.friction=0.9"], changes)
    assert slow.laboratory.runner.arm.settings.lift_speed_m_s == 0.05
    assert same.laboratory.runner.settings == light.laboratory.runner.settings
    models = [instantiate(it.laboratory.runner.objects).load("pringles_bbq") for it in (same, light)]
    assert models[1].mass_kg == 0.5 * models[0].mass_kg
    assert models[0].friction == models[1].friction == 0.9


def planned_grasp(laboratory: Laboratory, scene: Scene, number: int, offset_m: float) -> PlannedGrasp:
    """From the camera's side, thumb up, fingers away from the robot."""
    rotation = np.stack(([0.0, 1, 0], [0.0, 0, 1], [1.0, 0, 0]), axis=1)
    position = scene.T_world_object[:3, 3] - np.array((0.0, offset_m, 0.0))
    T_camera_palm = invert_pose(scene.camera.T_world_camera) @ make_pose(rotation, position)
    theta = laboratory.space.theta(T_camera_palm, np.array((0.0, 0, 0, 0, 0, 0, 1.396, 0.5)))
    return PlannedGrasp(number, "heuristic", Face.SIDE_NEAREST, theta, theta, NAN, seed=3)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table of one lifted and one missed grasp, and the cache that goes with it."""
    folder = tmp_path_factory.mktemp("recorded")
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        laboratory = instantiate(compose("sensitivity", [f"paths.cache={folder}/cache"]).laboratory)
    model = laboratory.scenes.objects.load("pringles_bbq")
    place = np.array((0.8, 0.0, laboratory.scenes.table.top_m + model.standing_height_m))
    scene = Scene(0, "pringles_bbq", make_pose(np.eye(3), place), laboratory.scenes.camera, 5)
    trials: list[Trial] = [
        laboratory.runner.run(scene, planned_grasp(laboratory, scene, number, offset_m))
        for number, offset_m in ((0, 0.068), (1, 0.25))
    ]
    assert [trial.outcome for trial in trials] == [LIFTED, MISSED]
    origin = laboratory.origin
    write_data_set(
        folder, SceneTable(origin, (scene,)), TrialTable.from_trials(trials, laboratory.space, origin)
    )
    return folder


Run = Callable[..., str]


@pytest.fixture
def run(ready_python: ReadyPython, recorded: Path) -> Run:
    """Run a command with the recorded table, to its good end; returns what it said."""

    def run(command: str, *overrides: str) -> str:
        places = (f"table={recorded}", f"paths.cache={recorded}/cache", f"paths.outputs={recorded}/outputs")
        script = project_root() / "sim" / f"{command}.py"
        done = ready_python.run(script, *places, "workers=1", *overrides, cwd=recorded)
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    return run


def test_the_same_settings_flip_nothing_and_finished_variants_are_kept(run: Run, recorded: Path) -> None:
    overrides = (
        f"output={recorded}/flips.json",
        "trials=2",
        "only=[unchanged,object_displaced]",
        "trials_of.object_displaced=2",
    )
    run("sensitivity", *overrides)
    variants = read_json(recorded / "flips.json")["variants"]
    assert (variants["unchanged"]["flips"], variants["unchanged"]["identical"]) == (0, 2)
    assert variants["object_displaced"]["soft_labels"] is not None
    kept = {path: path.stat().st_mtime_ns for path in (recorded / "cache" / "sensitivity").iterdir()}
    assert len(kept) == 2
    assert "Repeating" not in run("sensitivity", *overrides)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert read_json(recorded / "flips.json")["variants"] == variants


def test_last_frames_stand_on_a_sheet_for_each_label(run: Run, recorded: Path) -> None:
    sheets = (
        f"output={recorded}/sheets",
        "trials=2",
        f"result={recorded}/check.json",
        "disagreements=0",
        "how=eye",
    )
    said = run("last_frames", *sheets)
    assert "0 ended otherwise than recorded" in said
    for name in ("lifted", "failed"):
        with Image.open(recorded / "sheets" / f"last_frames_{name}.webp") as sheet:
            assert np.asarray(sheet.convert("L")).std() > 10
    check = read_json(recorded / "check.json")
    assert (check["n"], check["disagreements"], check["trials"]) == (2, 0, [0, 1])
