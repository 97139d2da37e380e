"""`python src/plan.py`: views and networks in, grasps out, bad input refused."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
from PIL import Image
from ready_python import ReadyPython
from synthetic_scenes import BoxRenderer, make_scene

from preshape.configured_planner import plan_view
from preshape.geometry.camera import Camera
from preshape.geometry.pose import make_pose
from preshape.models.checkpoints import save_weights
from preshape.models.palm_points import PalmPoints
from preshape.perception.observation import Observation
from preshape.perception.view_files import save_view

PLAN = Path(__file__).parents[2] / "src" / "plan.py"
SIMULATOR = ("sapien", "sim", "ompl")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a view and with weights."""
    folder = tmp_path_factory.mktemp("plan")
    save_view(folder / "view", BoxRenderer()(make_scene(0)))
    torch.manual_seed(0)
    model = PalmPoints("palm_points", "allegro_palm14", 14)
    save_weights(folder / "model.safetensors", model, data_hash="none", git_revision="none", metrics={})
    return folder


FILES = ("rgb_file=view/rgb.png", "depth_file=view/depth.png", "camera_file=view/camera.json")
Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def plan(ready_python: ReadyPython, folder: Path, tmp_path: Path) -> Command:
    """Run the command in the folder, as without a simulator; it writes to `out` of the test's own folder."""

    def run(*overrides: str) -> subprocess.CompletedProcess[str]:
        settings = (f"paths.outputs={tmp_path / 'runs'}", f"output={tmp_path / 'out'}")
        return ready_python.run(PLAN, *settings, *overrides, cwd=folder, absent=SIMULATOR)

    return run


def test_plans_are_written_ranked_and_drawn(plan: Command, tmp_path: Path) -> None:
    done = plan("view=view", "weights=model.safetensors", "planner.method.max_iterations=3")
    assert done.returncode == 0, done.stderr
    content = json.loads((tmp_path / "out" / "grasps.json").read_text())
    probs = [grasp["success_prob"] for grasp in content["grasps"]]
    assert len(probs) == 3
    assert probs == sorted(probs, reverse=True)
    assert all(grasp["success_prob"] >= grasp["initial_success_prob"] for grasp in content["grasps"])
    with Image.open(tmp_path / "out" / "grasps.png") as picture:
        assert picture.width > 3 * picture.height / 2
    last_line = done.stdout.strip().splitlines()[-1]
    assert f"{max(probs):.3f}" in last_line
    assert last_line.endswith(str(tmp_path / "out" / "grasps.json"))


def test_heuristic_needs_no_weights_and_single_files_will_do(plan: Command, tmp_path: Path) -> None:
    done = plan("planner=heuristic", *FILES)
    assert done.returncode == 0, done.stderr
    content = json.loads((tmp_path / "out" / "grasps.json").read_text())
    assert [grasp["success_prob"] for grasp in content["grasps"]] == [None] * 3


@pytest.fixture(scope="module")
def overhead(folder: Path) -> Observation:
    """A red box of 50 x 120 x 100 mm in the middle of a table, seen from 1 m straight above."""
    T_world_camera = make_pose(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 1.0]))
    camera = Camera(640, 480, 600.0, 600.0, 319.5, 239.5, T_world_camera)
    rgb, depth = np.full((480, 640, 3), 200, dtype=np.uint8), np.ones((480, 640), dtype=np.float32)
    half_u, half_v = (round(600 / 0.9 * size / 2) for size in (0.05, 0.12))
    top = slice(240 - half_v, 240 + half_v), slice(320 - half_u, 320 + half_u)
    rgb[top], depth[top] = (180, 20, 20), 0.9
    view = Observation(rgb, depth, None, camera)
    save_view(folder / "overhead", view)
    return view


def test_rectangles_are_planned_for_a_gripper(
    plan: Command, folder: Path, overhead: Observation, tmp_path: Path
) -> None:
    torch.manual_seed(0)
    with initialize_config_dir(str(PLAN.parents[1] / "conf"), version_base="1.3"):
        network = instantiate(compose("plan", ["robot=baxter"]).model)
    weights = folder / "rectangles.safetensors"
    save_weights(weights, network, data_hash="none", git_revision="none", metrics={})
    done = plan("robot=baxter", "view=overhead", f"weights={weights}", "planner.method.max_iterations=2")
    assert done.returncode == 0, done.stderr
    content = json.loads((tmp_path / "out" / "grasps.json").read_text())
    assert (content["planner"], content["names"][2:]) == ("paper_rectangle", ["angle", "opening"])
    assert len(content["grasps"]) == 4
    for grasp in content["grasps"]:
        assert grasp["success_prob"] >= grasp["initial_success_prob"]
        u, v, _, opening = grasp["theta"]
        place = np.array([(u - 319.5) / 600, -(v - 239.5) / 600, 1.0]) * (0.9, 0.9, 0.07)
        # the fingers' ends are 30 mm below the top of the box, which is 100 mm high
        np.testing.assert_allclose(np.array(grasp["T_world_palm"])[:3, 3], place, atol=0.002)
        np.testing.assert_allclose(np.array(grasp["T_table_palm"])[:3, 0], (0, 0, -1), atol=0.02)
        assert grasp["opening_m"] == pytest.approx(opening * 0.9 / 600, rel=0.02)
    with Image.open(tmp_path / "out" / "grasps.png") as picture:
        assert picture.width > 3 * picture.height


def test_an_image_of_another_size_is_refused_for_rectangles(plan: Command, tmp_path: Path) -> None:
    refused(plan("robot=baxter", "planner=heuristic", "view=view"), "640 x 480", tmp_path)


def test_three_lines_of_python_plan_the_same(plan: Command, folder: Path, tmp_path: Path) -> None:
    assert plan("view=view", "planner=heuristic").returncode == 0
    content = json.loads((tmp_path / "out" / "grasps.json").read_text())
    again = plan_view(folder / "view", None, "planner=heuristic")
    for grasp in content["grasps"]:
        np.testing.assert_array_equal(again.result.theta[grasp["start"]], grasp["theta"])
        np.testing.assert_allclose(again.palm_pose_over_table(grasp["start"]), grasp["T_table_palm"])


def test_a_truncated_view_is_refused(plan: Command, folder: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.png"
    whole = (folder / "view" / "rgb.png").read_bytes()
    damaged.write_bytes(whole[: len(whole) // 2])
    refused(plan("view=view", f"rgb_file={damaged}", "planner=heuristic"), "cannot be read", tmp_path)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["view=view"], "planner=heuristic"),
        (["planner=heuristic"], "No view was given"),
        (["view=view", "weights=view/rgb.png"], "sidecar"),
    ],
    ids=["no weights", "no view", "foreign weights"],
)
def test_bad_choices_are_refused(overrides: list[str], message: str, plan: Command, tmp_path: Path) -> None:
    refused(plan(*overrides), message, tmp_path)


def refused(done: subprocess.CompletedProcess[str], message: str, tmp_path: Path) -> None:
    """One clear message, status 2, no traceback, nothing written."""
    assert done.returncode == 2, done.stderr
    assert message in done.stderr
    assert done.stderr.startswith("ERROR: ")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()
