"""Rectangles executed by the gripper, and the folder in Cornell's layout that is made of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.cornell.data_set import read_cornell
from preshape.cornell.rectangle_metric import jaccard
from preshape.cornell.views import load_cornell_view
from preshape.data.scene import Scene
from preshape.data.tables import write_data_set
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.geometry.pose import make_pose
from preshape.grasps.rectangle_space import rectangle_of
from preshape.models.checkpoints import save_weights
from preshape.paths import project_root
from preshape.planning.plan_files import read_plan
from sim.laboratory import Laboratory
from sim.planner_contest import EvaluationSettings, Evaluator, try_planners
from sim.recorder import Recorder, RecorderSettings
from sim.simulated_cornell import SimulatedCornell
from sim.stretched_objects import StretchedObjects
from sim.trial import PlannedGrasp

BOX = "cheez_it_white_cheddar"


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    cache = tmp_path_factory.mktemp("cache")
    overrides = ["robot=baxter", "camera=overhead", "collect.explored=4", f"paths.cache={cache}"]
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        return instantiate(compose("collect", overrides).laboratory)


@pytest.fixture(scope="module")
def scene(laboratory: Laboratory) -> Scene:
    model = laboratory.scenes.objects.load(BOX)
    table = laboratory.scenes.table
    pose = make_pose(np.eye(3), np.array((0.6, 0.0, table.top_m + model.standing_height_m)))
    return Scene(0, BOX, pose, laboratory.scenes.camera, 5)


@pytest.fixture(scope="module")
def across(laboratory: Laboratory, scene: Scene) -> np.ndarray:
    """Theta of a rectangle across the box: at the middle of its top, along its thin side."""
    model = laboratory.scenes.objects.load(BOX)
    top = scene.T_world_object[:3, 3] + (0.0, 0.0, model.bounds[1, 2])
    thin = np.eye(3)[np.argmin(model.size[:2])]
    ends = np.array([top - 0.033 * thin, top + 0.033 * thin])
    in_camera = (ends - scene.camera.T_world_camera[:3, 3]) @ scene.camera.T_world_camera[:3, :3]
    (u0, u1), (v0, v1) = scene.camera.project(in_camera)
    angle = np.arctan2(v1 - v0, u1 - u0) % np.pi
    return np.array([(u0 + u1) / 2, (v0 + v1) / 2, angle, np.hypot(u1 - u0, v1 - v0)])


def grasp(number: int, theta: np.ndarray) -> PlannedGrasp:
    return PlannedGrasp(number, "exploration", Face.TOP, theta, theta, float("nan"), seed=3)


@pytest.fixture(scope="module")
def trials(laboratory: Laboratory, scene: Scene, across: np.ndarray) -> list[Trial]:
    """Across the box, along it, and beside it."""
    along, beside = across.copy(), across.copy()
    along[2] = (along[2] + np.pi / 2) % np.pi
    beside[:2] += 90.0
    return [laboratory.runner.run(scene, grasp(k, theta)) for k, theta in enumerate((across, along, beside))]


def test_a_box_is_lifted_across_its_thin_side_only(trials: list[Trial]) -> None:
    across, along, beside = trials
    assert across.outcome is TrialOutcome.LIFTED
    assert across.lift_height_m == pytest.approx(0.2, abs=0.02)
    assert jaccard(rectangle_of(across.reached), rectangle_of(across.planned)) > 0.95
    assert {along.outcome, beside.outcome} == {TrialOutcome.MISSED}
    # the fingers came down on the box, and the gripper did not get where it should
    assert jaccard(rectangle_of(along.reached), rectangle_of(along.planned)) < 0.95


def test_a_trial_repeats_to_the_bit_whoever_looks_on(
    laboratory: Laboratory, scene: Scene, across: np.ndarray, trials: list[Trial]
) -> None:
    film = Recorder(RecorderSettings(every=20))
    again = laboratory.runner.run(scene, grasp(0, across), film)
    assert film.phases[-1] == "hold"
    assert again.reached.tobytes() == trials[0].reached.tobytes()
    assert again.lift_height_m == trials[0].lift_height_m


def test_proposed_rectangles_lie_where_they_should(laboratory: Laboratory, scene: Scene) -> None:
    view = laboratory.view(scene)
    centre = np.argwhere(view.segmented.mask)[:, ::-1].mean(axis=0)
    thetas = np.array([start.theta for start in view.initial])
    assert thetas.shape == (4, 4)
    np.testing.assert_allclose(thetas[:, :2], np.tile(centre, (4, 1)))
    np.testing.assert_array_equal(thetas[:, 3], 30.0)
    explored = laboratory.explored(scene, view)
    assert len(view.initial) + len(explored) == laboratory.grasps_per_scene
    repeated = laboratory.explored(scene, view)
    assert [e.theta.tobytes() for e in explored] == [e.theta.tobytes() for e in repeated]
    assert all(0 <= e.theta[2] < np.pi for e in explored)
    aligned = [laboratory.runner.run(scene, grasp(9, explored[k].theta)) for k in (0, 2)]
    assert TrialOutcome.LIFTED in {trial.outcome for trial in aligned}


@pytest.fixture(scope="module")
def evaluator(laboratory: Laboratory, tmp_path_factory: pytest.TempPathFactory) -> Evaluator:
    """The paper's experiment and one planner more, with a network that has learned nothing."""
    place = tmp_path_factory.mktemp("experiment")
    weights = place / "model.safetensors"
    more = "+planner@planners.multi_start=rectangle_multi_start"
    overrides = ["experiment=two_finger", more, f"paths.cache={place}", f"weights={weights}"]
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("evaluate", overrides)
    torch.manual_seed(0)
    save_weights(weights, instantiate(cfg.model), data_hash="none", git_revision="none", metrics={})
    cfg.evaluator.laboratory = None
    return replace(instantiate(cfg.evaluator), laboratory=laboratory)


def test_planners_of_rectangles_compete(evaluator: Evaluator, scene: Scene, tmp_path: Path) -> None:
    settings = EvaluationSettings(scenes=1, seed=1)
    tried = try_planners(evaluator, settings, scene, tmp_path)
    own = {name: [trial for trial in tried if trial.planner == name] for name in evaluator.planners}
    assert set(own) == {"heuristic", "max_eval", "inference", "multi_start"}
    assert len(own["heuristic"]) == 4
    np.testing.assert_array_equal(own["max_eval"][0].planned, own["max_eval"][0].initial)
    best = own["inference"][0]
    assert best.success_prob >= max(trial.success_prob for trial in own["heuristic"])
    assert own["multi_start"][0].success_prob >= best.success_prob
    plan = read_plan(tmp_path / "plans" / "0_inference.json", evaluator.laboratory.space)
    np.testing.assert_array_equal(plan.result.theta[plan.result.best], best.planned)
    # what the plan says in metres is where the robot takes the gripper
    placed = evaluator.laboratory.runner.meaning.place(
        scene, best.planned, evaluator.laboratory.runner.table, evaluator.laboratory.runner.look
    )
    approach = placed.T_world_palm[:3, 0]
    np.testing.assert_allclose(plan.palm_pose_in_world(plan.result.best)[:3, 0], approach, atol=0.02)
    np.testing.assert_allclose(
        plan.palm_pose_in_world(plan.result.best)[:3, 3], placed.T_world_palm[:3, 3], atol=0.005
    )


def test_planners_for_hands_are_refused(laboratory: Laboratory) -> None:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        for_hands = compose("plan", ["robot=baxter", "planner=inference", "paths.cache=unused"])
        for_grippers = compose("plan", ["planner=paper_rectangle", "paths.cache=unused"])
    for cfg, fix in ((for_hands, "planner=paper_rectangle"), (for_grippers, "planner=inference")):
        cfg.planner_parts.constraint = None
        with pytest.raises(InputError, match="not for") as refusal:
            instantiate(cfg.planning).planner(instantiate(cfg.planner_parts))
        assert fix in str(refusal.value)


def test_executed_rectangles_become_a_data_set_in_cornells_layout(
    laboratory: Laboratory, scene: Scene, trials: list[Trial], tmp_path: Path
) -> None:
    scenes = (scene, replace(scene, scene_id=1))
    missed = replace(trials[2], trial_id=9, scene_id=1)  # nothing was lifted there
    table = TrialTable.from_trials([*trials, missed], laboratory.space, laboratory.origin)
    write_data_set(tmp_path / "table", SceneTable(laboratory.origin, scenes), table)
    runner = laboratory.runner
    maker = SimulatedCornell(
        tmp_path / "table", laboratory.space, laboratory.renderer, runner.meaning, runner.table, 0.8
    )
    root = tmp_path / "cornell"
    maker(root)
    (image,) = read_cornell(root).images
    assert (image.files.number, image.subject.category) == (0, BOX)
    labelled = [trial.planned for trial in trials]
    for found, theta in zip((*image.positives, *image.negatives), labelled, strict=True):
        assert jaccard(found, rectangle_of(theta)) > 0.999
    seen, view = load_cornell_view(image.files).observation, laboratory.renderer(scene)
    np.testing.assert_array_equal(seen.rgb, view.rgb)
    both = np.isfinite(seen.depth) & np.isfinite(view.depth)
    np.testing.assert_allclose(seen.depth[both], view.depth[both], atol=5e-4)
    assert both[view.mask].mean() > 0.7  # the sensor loses steep sides
    np.testing.assert_allclose(seen.camera.T_world_camera[:3, 3], (0.42, 0.0, 0.79), atol=1e-3)
    written = {path: path.stat().st_mtime_ns for path in root.glob("01/*")}
    (root / "01" / "pcd0000cneg.txt").unlink()
    maker(root)
    assert all(path.is_file() for path in written)
    with pytest.raises(InputError, match="something else"):
        maker(tmp_path / "table")


def test_stretched_copies_of_added_tables_count_as_their_original(
    laboratory: Laboratory, scene: Scene, trials: list[Trial], tmp_path: Path
) -> None:
    """No part of the images may hold a copy of what another part tests."""
    copy, objects = f"{BOX}_stretched_1", StretchedObjects(laboratory.renderer.objects, copies=1, most=1.1)
    stretched = [replace(trial, object_id=copy) for trial in trials]
    for name, own_scene, own_trials in (
        ("originals", scene, trials),
        ("copies", replace(scene, object_id=copy), stretched),
    ):
        table = TrialTable.from_trials(own_trials, laboratory.space, laboratory.origin)
        write_data_set(tmp_path / name, SceneTable(laboratory.origin, (own_scene,)), table)
    runner = laboratory.runner
    maker = SimulatedCornell(
        tmp_path / "originals",
        laboratory.space,
        replace(laboratory.renderer, objects=objects),
        runner.meaning,
        runner.table,
        0.8,
        added=[tmp_path / "copies"],
    )
    maker(tmp_path / "cornell")
    images = read_cornell(tmp_path / "cornell").images
    assert [image.files.number for image in images] == [0, 1]
    assert {(image.subject.object_id, image.subject.category) for image in images} == {(0, BOX)}
    views = [load_cornell_view(image.files).observation.rgb for image in images]
    assert not np.array_equal(*views)
