"""Explored grasps stray from the heuristic ones as far as the settings say, and in nothing else."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from preshape.geometry.camera import Camera
from preshape.geometry.pose import invert_pose, make_pose
from preshape.grasps.exploration import ExplorationSettings, explored_grasps
from preshape.grasps.heuristic import HeuristicSettings, InitialGrasp, heuristic_grasps
from preshape.grasps.space import GraspSpace
from preshape.perception.segmentation import SegmentedObject

SPACE = GraspSpace.palm_and_joints("test", {"finger_0": (-0.47, 0.47), "thumb_0": (0.263, 1.396)})
HEURISTIC = HeuristicSettings(
    {"finger_0": (-0.3, 0.28), "thumb_0": (1.396, 1.396)}, offset_noise_m=0.0, axis_noise_rad=0.0
)
CAMERA = Camera.looking_at(
    np.array([0.8, -0.9, 1.25]), np.array([0.8, 0.0, 0.65]), width=640, height=480, focal=525.0
)


@pytest.fixture(scope="module")
def box() -> SegmentedObject:
    """A tall box in front of the camera."""
    T_camera_box = invert_pose(CAMERA.T_world_camera) @ make_pose(np.eye(3), np.array([0.8, 0.0, 0.69]))
    normal = T_camera_box[:3, 2]
    plane = np.append(normal, -normal @ (T_camera_box[:3, 3] - 0.1 * normal))
    extents = np.array([0.08, 0.06, 0.2])
    return SegmentedObject(np.zeros((0, 3)), np.zeros((480, 640), dtype=bool), plane, T_camera_box, extents)


def explore(box: SegmentedObject, settings: ExplorationSettings, seed: int = 0) -> list[InitialGrasp]:
    return explored_grasps(box, SPACE, HEURISTIC, settings, CAMERA, np.random.default_rng(seed))


def test_without_noise_they_are_new_draws_of_the_heuristic_grasps(box: SegmentedObject) -> None:
    drawn = heuristic_grasps(box, SPACE, HEURISTIC, CAMERA, np.random.default_rng(0))
    explored = explore(box, ExplorationSettings(1, position_m=0.0, rotation_rad=0.0))
    assert [grasp.face for grasp in explored] == [grasp.face for grasp in drawn]
    for one, other in zip(explored, drawn, strict=True):
        np.testing.assert_allclose(SPACE.palm_pose(one.theta), SPACE.palm_pose(other.theta), atol=1e-12)
        np.testing.assert_array_equal(SPACE.joints(one.theta), SPACE.joints(other.theta))


def test_the_palm_strays_with_the_deviations_of_the_settings(box: SegmentedObject) -> None:
    settings = ExplorationSettings(400, position_m=0.02, rotation_rad=0.1)
    places = {g.face: SPACE.palm_pose(g.theta) for g in explore(box, ExplorationSettings(1, 0.0, 0.0))}
    sides = [grasp for grasp in explore(box, settings) if grasp.face.value != "top"]
    shifts, turns = [], []
    for grasp in sides:
        palm, place = SPACE.palm_pose(grasp.theta), places[grasp.face]
        shifts.append(palm[:3, 3] - place[:3, 3])
        turns.append(Rotation.from_matrix(place[:3, :3].T @ palm[:3, :3]).as_rotvec())
    assert len(sides) == 800
    np.testing.assert_allclose(np.std(shifts, axis=0), 0.02, rtol=0.15)
    np.testing.assert_allclose(np.std(turns, axis=0), 0.1, rtol=0.15)
    np.testing.assert_allclose(np.mean(shifts, axis=0), 0.0, atol=0.003)


def test_a_seed_gives_the_same_grasps_and_none_are_made_unless_asked_for(box: SegmentedObject) -> None:
    one, other = (explore(box, ExplorationSettings(1), seed=4) for _ in range(2))
    assert [g.theta.tobytes() for g in one] == [g.theta.tobytes() for g in other]
    assert explore(box, ExplorationSettings()) == []
