"""Trials of a table in the viewer, executed in the simulator."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from viser import ViserServer

import preshape.command_line.entry_point  # noqa: F401 - registers what the configuration refers to
from preshape.configured_planner import planner_of
from preshape.data.scene import Scene
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.geometry.pose import invert_pose, make_pose, pose_from_quaternion
from preshape.paths import project_root
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.recording import TrialRecording, read_recording
from preshape.viewer.server import ServerSettings, open_server
from preshape.viewer.trial_session import TrialParts, TrialSession
from preshape.viewer.trial_stage import NotExecuted
from preshape.viewer.trial_story import trial_story
from sim.repetition import recorded_grasp
from sim.state_recorder import StateRecorder
from sim.trial import PlannedGrasp
from sim.viewer_stage import LaboratoryStage

CAN, BOX = "pringles_bbq", "cheez_it_white_cheddar"


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> TrialParts:
    """Three trials of a can: around its middle, before it, and out of reach; and one of a box."""
    overrides = [
        f"paths.cache={tmp_path_factory.mktemp('cache')}",
        *("camera=kinect_ideal", "planner=heuristic", "weights=null"),
    ]
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("view", overrides)
    stage = instantiate(cfg.stage)
    assert isinstance(stage, LaboratoryStage)
    scenes = [scene_with(stage, number, name) for number, name in enumerate((CAN, BOX))]
    around = side_theta(stage, scenes[0], np.zeros(3))
    before = side_theta(stage, scenes[0], np.array([0.0, -0.15, 0.0]))
    away = side_theta(stage, scenes[0], np.array([0.0, 3.0, 0.0]))
    trials = [
        trial(0, scenes[0], around, TrialOutcome.LIFTED),
        trial(1, scenes[0], before, TrialOutcome.MISSED),
        trial(2, scenes[0], away, TrialOutcome.UNREACHABLE),
        trial(3, scenes[1], side_theta(stage, scenes[1], np.zeros(3)), TrialOutcome.MISSED),
    ]
    laboratory = stage.laboratory
    table = TrialTable.from_trials(trials, laboratory.space, laboratory.origin)
    scene_table = SceneTable(laboratory.origin, tuple(scenes))
    planner = planner_of(cfg)
    return TrialParts(laboratory.runner.robot, scene_table, table, stage, planner)


def scene_with(stage: LaboratoryStage, number: int, object_id: str) -> Scene:
    laboratory = stage.laboratory
    height = laboratory.scenes.table.top_m + laboratory.scenes.objects.load(object_id).standing_height_m
    pose = make_pose(np.eye(3), np.array((0.8, 0.0, height)))
    return Scene(number, object_id, pose, laboratory.scenes.camera, 5)


def side_theta(stage: LaboratoryStage, scene: Scene, shift: np.ndarray) -> np.ndarray:
    """From the camera's side, thumb up, fingers away from the robot."""
    rotation = np.stack(([0.0, 1, 0], [0.0, 0, 1], [1.0, 0, 0]), axis=1)
    palm = make_pose(rotation, scene.T_world_object[:3, 3] - np.array((0.0, 0.068, 0.0)) + shift)
    joints = np.array((0.0, 0, 0, 0, 0, 0, 1.396, 0.5))
    return stage.laboratory.space.theta(invert_pose(scene.camera.T_world_camera) @ palm, joints)


def trial(number: int, scene: Scene, theta: np.ndarray, outcome: TrialOutcome) -> Trial:
    grasp = PlannedGrasp(number, "heuristic", Face.SIDE_NEAREST, theta, theta, float("nan"), seed=3)
    return replace(grasp.untried(scene, outcome), reached=theta)


@pytest.fixture
def session(parts: TrialParts) -> Iterator[tuple[TrialSession, JobQueue]]:
    server: ViserServer = open_server(ServerSettings(port=0))
    jobs = JobQueue()
    session = TrialSession(server, jobs, parts)
    jobs.work_off()
    yield session, jobs
    server.stop()


def test_a_repeated_trial_is_seen_as_it_was(
    session: tuple[TrialSession, JobQueue], parts: TrialParts
) -> None:
    viewer, jobs = session
    jobs.put(viewer.perform_recorded)
    jobs.work_off()
    recording = viewer.replay.recording
    assert recording is not None
    assert recording.outcome is TrialOutcome.LIFTED
    assert list(dict.fromkeys(recording.phases)) == ["transit", "approach", "close", "lift", "hold"]
    assert recording.object_rise_m[-1] == pytest.approx(0.15, abs=0.02)
    points, touching = recording.contacts_at(len(recording) - 1)
    assert {"thumb"} < set(touching) <= {"thumb", "index", "middle", "ring", "palm"}
    object_m = recording.T_world_object[-1, :3, 3]
    assert np.linalg.norm(points - object_m, axis=1).max() < 0.15
    assert "LIFTED" in trial_story(recording)
    set_value(viewer.replay.playing, False)
    set_value(viewer.replay.instant, len(recording) - 1)
    jobs.work_off()
    robot = viewer.scene.robot
    assert robot is not None
    assert robot.visible
    palm = robot.nodes["palm_link_0"]
    np.testing.assert_allclose(
        pose_from_quaternion(palm.position, palm.wxyz), recording.T_world_palm[-1], atol=1e-5
    )
    check_files(parts, recording)


def check_files(parts: TrialParts, recording: TrialRecording) -> None:
    """The recording was kept, comes back to the bit, and is refused where it is damaged."""
    assert isinstance(parts.stage, LaboratoryStage)
    (path,) = parts.stage.recordings.glob("0_*.npz")
    again = read_recording(path)
    assert again.T_world_object.tobytes() == recording.T_world_object.tobytes()
    assert (again.phases, again.contact_parts) == (recording.phases, recording.contact_parts)
    damaged = Path(path.parent / "damaged.npz")
    damaged.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match="damaged"):
        read_recording(damaged)


def test_a_grasp_before_the_object_misses_it(parts: TrialParts) -> None:
    recording = parts.stage.perform(parts.scenes.by_id[0], parts.trials.to_trials()[1])
    assert isinstance(recording, TrialRecording)
    assert recording.outcome is TrialOutcome.MISSED
    assert len(recording.contact_points) == 0
    assert "without touching the object" in trial_story(recording)


def test_whoever_looks_on_changes_no_trial(parts: TrialParts) -> None:
    """Not even after a view with the robot in it, whose stage has another friction."""
    assert isinstance(parts.stage, LaboratoryStage)
    runner, scene = parts.stage.laboratory.runner, parts.scenes.by_id[0]
    grasp = recorded_grasp(parts.trials.to_trials()[0])
    parts.stage.look(scene)
    alone, watched = runner.run(scene, grasp), runner.run(scene, grasp, StateRecorder(1 / 60))
    assert watched.reached.tobytes() == alone.reached.tobytes()
    assert watched.lift_height_m == alone.lift_height_m


def test_a_grasp_out_of_reach_says_why(parts: TrialParts) -> None:
    answer = parts.stage.perform(parts.scenes.by_id[0], parts.trials.to_trials()[2])
    assert isinstance(answer, NotExecuted)
    assert answer.outcome is TrialOutcome.UNREACHABLE
    assert answer.reason


def test_only_trials_of_the_object_and_outcome_are_shown(session: tuple[TrialSession, JobQueue]) -> None:
    viewer, jobs = session
    seen = {}
    for name, outcome in ((CAN, "executed"), (CAN, "unreachable"), (BOX, "executed"), (BOX, "lifted")):
        set_value(viewer.trials.object, name)
        set_value(viewer.trials.outcome, outcome)
        jobs.work_off()
        seen[name, outcome] = viewer.trials.rows.tolist()
        shown = viewer.trials.trial
        assert (shown is None) == (seen[name, outcome] == [])
        assert shown is None or shown.object_id == name
    assert list(seen.values()) == [[0, 1], [2], [3], []]
