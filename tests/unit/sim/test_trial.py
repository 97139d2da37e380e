"""A trial depends on its scene, grasp and seed alone, whoever looks on."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.scene import Scene
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.geometry.pose import invert_pose, make_pose
from preshape.paths import project_root
from sim.laboratory import Laboratory
from sim.recorder import Recorder, RecorderSettings
from sim.trial import DisturbanceSettings, PlannedGrasp, TrialRunner

TIMINGS = {"scene_s", "planning_s", "physics_s", "rendering_s"}


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    cache = tmp_path_factory.mktemp("cache")
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("collect", [f"paths.cache={cache}", "camera=kinect_ideal"])
        return instantiate(cfg.laboratory)


def scene_with(laboratory: Laboratory, object_id: str) -> Scene:
    model = laboratory.scenes.objects.load(object_id)
    top = laboratory.scenes.table.top_m
    position = np.array((0.8, 0.0, top + model.standing_height_m))
    return Scene(0, object_id, make_pose(np.eye(3), position), laboratory.scenes.camera, 5)


def side_grasp(laboratory: Laboratory, scene: Scene, offset_m: float) -> PlannedGrasp:
    """From the camera's side, thumb up, fingers away from the robot."""
    rotation = np.stack(([0.0, 1, 0], [0.0, 0, 1], [1.0, 0, 0]), axis=1)
    position = scene.T_world_object[:3, 3] - np.array((0.0, offset_m, 0.0))
    T_camera_palm = invert_pose(scene.camera.T_world_camera) @ make_pose(rotation, position)
    joints = np.array((0.0, 0, 0, 0, 0, 0, 1.396, 0.5))
    theta = laboratory.space.theta(T_camera_palm, joints)
    return PlannedGrasp(0, "heuristic", Face.SIDE_NEAREST, theta, theta, float("nan"), seed=3)


def decided_by_the_seed(trial: Trial) -> dict[str, object]:
    """All fields but the timings; arrays as their bytes, so that equal means equal to the bit."""
    values = {field.name: getattr(trial, field.name) for field in fields(Trial) if field.name not in TIMINGS}
    return {name: v.tobytes() if isinstance(v, np.ndarray) else repr(v) for name, v in values.items()}


def test_a_can_held_around_its_middle_is_lifted_and_every_repetition_agrees_to_the_bit(
    laboratory: Laboratory, tmp_path: Path
) -> None:
    scene = scene_with(laboratory, "pringles_bbq")
    grasp = side_grasp(laboratory, scene, 0.038 + 0.03)
    first = laboratory.runner.run(scene, grasp)
    assert first.outcome is TrialOutcome.LIFTED
    assert first.lift_height_m > 0.13
    np.testing.assert_allclose(first.reached, grasp.planned, atol=5e-3)
    film = Recorder(RecorderSettings(every=100))
    filmed = laboratory.runner.run(scene, grasp, film)
    assert decided_by_the_seed(first) == decided_by_the_seed(filmed)
    assert film.phases[-1] == "hold"
    film.save_animation(tmp_path / "trial.webp", filmed.outcome)
    assert (tmp_path / "trial.webp").stat().st_size > 1000


def test_a_hand_that_closes_beside_the_object_misses_it(laboratory: Laboratory) -> None:
    scene = scene_with(laboratory, "pringles_bbq")
    trial = laboratory.runner.run(scene, side_grasp(laboratory, scene, 0.25))
    assert trial.outcome is TrialOutcome.MISSED
    assert abs(trial.lift_height_m) < 0.01


def with_settings(runner: TrialRunner, **changes: object) -> TrialRunner:
    """The same runner but for some of its settings."""
    return replace(runner, settings=replace(runner.settings, **changes))


def test_a_lost_trial_ends_early_with_the_outcome_that_it_would_have_had(laboratory: Laboratory) -> None:
    runner = laboratory.runner
    patient = with_settings(runner, execution=replace(runner.settings.execution, lost_lag_m=None))
    scene = scene_with(laboratory, "pringles_bbq")
    for offset_m, outcome in ((0.068, TrialOutcome.LIFTED), (0.25, TrialOutcome.MISSED)):
        grasp = side_grasp(laboratory, scene, offset_m)
        film, whole_film = (Recorder(RecorderSettings(every=20)) for _ in range(2))
        early, whole = runner.run(scene, grasp, film), patient.run(scene, grasp, whole_film)
        assert early.outcome is whole.outcome is outcome
        assert early.reached.tobytes() == whole.reached.tobytes()
        lasts_as_long = len(film.frames) == len(whole_film.frames)
        assert lasts_as_long is (outcome is TrialOutcome.LIFTED)


def test_the_soft_label_is_the_share_of_lifted_repetitions(laboratory: Laboratory) -> None:
    scene = scene_with(laboratory, "pringles_bbq")
    sure = side_grasp(laboratory, scene, 0.068)
    assert np.isnan(laboratory.runner.run(scene, sure).soft_label)
    disturbed = with_settings(laboratory.runner, disturbances=DisturbanceSettings(repeats=2))
    trial, again = disturbed.run(scene, sure), disturbed.run(scene, sure)
    assert trial.outcome is TrialOutcome.LIFTED
    assert trial.soft_label == again.soft_label == 1.0
    once = with_settings(laboratory.runner, disturbances=DisturbanceSettings(repeats=1))
    assert once.run(scene, side_grasp(laboratory, scene, 0.25)).soft_label == 0.0
    hopeless = with_settings(laboratory.runner, disturbances=DisturbanceSettings(repeats=1, position_m=0.5))
    assert hopeless.run(scene, sure).soft_label == 0.0


def test_a_grasp_out_of_reach_is_recorded_without_being_executed(laboratory: Laboratory) -> None:
    scene = scene_with(laboratory, "pringles_bbq")
    trial = laboratory.runner.run(scene, side_grasp(laboratory, scene, 2.0))
    assert trial.outcome is TrialOutcome.UNREACHABLE
    assert np.isnan(trial.reached).all()
    assert np.isnan(trial.lift_height_m)


def test_a_scene_is_a_function_of_seed_and_number(laboratory: Laboratory) -> None:
    one, other = laboratory.scenes.make(7, 3), laboratory.scenes.make(7, 3)
    assert one is not None
    assert other is not None
    assert one.seed == other.seed
    assert one.T_world_object.tobytes() == other.T_world_object.tobytes()
    different = laboratory.scenes.make(8, 3)
    assert different is None or different.seed != one.seed


def test_every_round_of_scenes_shows_every_object_once(laboratory: Laboratory) -> None:
    names = laboratory.scenes.objects.names
    for start in (0, len(names)):
        shown = [laboratory.scenes.object_of(0, start + k) for k in range(len(names))]
        assert sorted(shown) == sorted(names)
