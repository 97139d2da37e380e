"""An image is a pure function of its scene."""

import hashlib
import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from preshape.data.scene import Scene
from preshape.errors import InputError
from preshape.geometry.pose import make_pose, transform_points
from preshape.perception.observation import Observation
from sim.camera import camera_looking_at
from sim.kinect_noise import KinectNoise
from sim.objects.grocery import GrocerySet
from sim.scene_renderer import SapienSceneRenderer
from sim.table import TableSettings

GROCERY, TABLE = GrocerySet(), TableSettings()
IDEAL = SapienSceneRenderer(GROCERY, TABLE)
NOISY = SapienSceneRenderer(GROCERY, TABLE, KinectNoise())


def scene_of(name: str, *, seed: int = 3, x: float = 0.0) -> Scene:
    camera = camera_looking_at([0.8, -0.9, 1.25], [0.8, 0, 0.65], 640, 480, 525)
    height = TABLE.top_m + GROCERY.load(name).standing_height_m
    pose = make_pose(np.eye(3), np.array([0.8 + x, 0.0, height]))
    return Scene(1, name, pose, camera, seed)


def digest(observation: Observation) -> str:
    arrays = (observation.rgb, observation.depth, observation.mask)
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


def test_the_same_scene_gives_the_same_bits_whatever_was_rendered_between() -> None:
    scene = scene_of("pepto_bismol")
    first = digest(NOISY(scene))
    NOISY(scene_of("detergent", seed=9))
    IDEAL(scene)
    assert digest(NOISY(scene)) == first
    assert digest(NOISY(replace(scene, seed=4))) != first


def test_another_process_gives_the_same_bits() -> None:
    root = Path(__file__).parents[3]
    code = (
        "from test_scene_renderer import NOISY, digest, scene_of\n"
        "print(digest(NOISY(scene_of('pepto_bismol'))))"
    )
    paths = [str(root), str(root / "src"), str(Path(__file__).parent)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, "-c", code]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == digest(NOISY(scene_of("pepto_bismol")))


def test_the_mask_is_the_object() -> None:
    scene = scene_of("spam")
    seen = IDEAL(scene)
    assert seen.mask is not None
    points = transform_points(scene.camera.T_world_camera, seen.camera.unproject(seen.depth)[seen.mask])
    model = GROCERY.load("spam")
    in_object = points - scene.T_world_object[:3, 3]
    assert (in_object > model.bounds[0] - 1e-3).all()
    assert (in_object < model.bounds[1] + 1e-3).all()
    np.testing.assert_allclose(in_object.max(axis=0)[2], model.bounds[1, 2], atol=1e-3)
    around = transform_points(scene.camera.T_world_camera, seen.camera.unproject(seen.depth)[~seen.mask])
    on_table = around[(np.abs(around[:, 2] - TABLE.top_m) < 0.01) & (around[:, 1] > -0.45)]
    assert len(on_table) > 50_000
    np.testing.assert_allclose(on_table[:, 2], TABLE.top_m, atol=2e-4)


def test_what_is_sent_to_another_process_makes_the_same_image() -> None:
    scene = scene_of("spam")
    image = digest(NOISY(scene))
    sent = pickle.loads(pickle.dumps(NOISY))
    assert sent.fingerprint == NOISY.fingerprint
    assert digest(sent(scene)) == image


def test_each_camera_sees_its_own_view() -> None:
    scene = scene_of("spam")
    image = digest(IDEAL(scene))
    small = camera_looking_at([0.6, -0.8, 1.1], [0.8, 0, 0.65], 320, 240, 262)
    moved = camera_looking_at([0.7, -0.9, 1.25], [0.8, 0, 0.65], 640, 480, 525)
    assert IDEAL(replace(scene, camera=small)).depth.shape == (240, 320)
    assert digest(IDEAL(replace(scene, camera=moved))) != image
    assert digest(IDEAL(scene)) == image


def test_noise_touches_the_depth_only() -> None:
    scene = scene_of("red_bull")
    ideal, noisy = IDEAL(scene), NOISY(scene)
    np.testing.assert_array_equal(ideal.rgb, noisy.rgb)
    np.testing.assert_array_equal(ideal.mask, noisy.mask)
    assert np.isnan(noisy.depth).sum() > np.isnan(ideal.depth).sum()
    assert np.nanmedian(np.abs(noisy.depth - ideal.depth)[ideal.depth < 1.5]) < 3e-3


def test_each_object_is_seen_and_has_its_own_colours() -> None:
    means = []
    for name in ("pepto_bismol", "detergent", "red_bull"):
        seen = IDEAL(scene_of(name))
        assert seen.mask is not None
        assert seen.mask.sum() > 800
        means.append(seen.rgb[seen.mask].mean(axis=0))
    for k, mean in enumerate(means):
        for other in means[:k]:
            assert np.linalg.norm(mean - other) > 30


def test_the_fingerprint_follows_what_the_image_depends_on() -> None:
    assert SapienSceneRenderer(GrocerySet(), TableSettings()).fingerprint == IDEAL.fingerprint
    others = [
        NOISY,
        SapienSceneRenderer(GROCERY, TABLE, KinectNoise(baseline_m=0.05)),
        SapienSceneRenderer(GROCERY, replace(TABLE, sun=1.0)),
        SapienSceneRenderer(GrocerySet(density=200.0), TABLE),
    ]
    assert len({IDEAL.fingerprint, *(other.fingerprint for other in others)}) == 5


def test_an_object_of_another_set_is_refused() -> None:
    with pytest.raises(InputError, match="no object 'pizza'"):
        IDEAL(replace(scene_of("spam"), object_id="pizza"))


def test_a_machine_without_vulkan_is_told_what_to_do() -> None:
    code = "from sim.scene_systems import make_render_system\nmake_render_system()"
    root = Path(__file__).parents[3]
    no_driver = dict.fromkeys(("VK_ICD_FILENAMES", "VK_DRIVER_FILES"), "/nonexistent.json")
    environment = {**os.environ, **no_driver, "PYTHONPATH": os.pathsep.join([str(root), str(root / "src")])}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert run.returncode != 0
    assert "make setup" in run.stderr
