"""The arm and the hand put together: sizes, masses, limits, and what happens when something is wrong."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import sapien
from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.errors import InputError
from sim.robots import allegro
from sim.robots.description import RobotDescription, RobotSettings
from sim.robots.lbr4_allegro import load_robot

DH_DISTANCES_M = {
    ("lbr4_base_link", "lbr4_2_link"): 0.3105,
    ("lbr4_2_link", "lbr4_4_link"): 0.400,
    ("lbr4_4_link", "lbr4_6_link"): 0.390,
    ("lbr4_6_link", "lbr4_7_link"): 0.078,
}

Frames = Callable[[np.ndarray], dict[str, np.ndarray]]


@pytest.fixture(scope="module")
def settings(robot_config: DictConfig) -> RobotSettings:
    return instantiate(robot_config.robot.description.settings)


@pytest.fixture(scope="module")
def articulation(robot: RobotDescription) -> Iterator[sapien.physx.PhysxArticulation]:
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem()])
    articulation = scene.create_urdf_loader().load(str(robot.urdf_path))
    articulation.set_root_pose(sapien.Pose(robot.T_world_base))
    yield articulation
    del scene  # it must outlive its articulation


@pytest.fixture(scope="module")
def frames(robot: RobotDescription) -> Frames:
    """Poses (base frame) of all links at 23 joint angles in the order arm, hand."""
    model = pin.buildModelFromUrdf(str(robot.urdf_path))
    data = model.createData()
    order = [model.joints[model.getJointId(name)].idx_q for name in robot.arm_joints + robot.hand_joints]

    def at(angles: np.ndarray) -> dict[str, np.ndarray]:
        positions = np.zeros(model.nq)
        positions[order] = angles
        pin.framesForwardKinematics(model, data, positions)
        return {frame.name: data.oMf[k].homogeneous for k, frame in enumerate(model.frames)}

    return at


def random_angles(robot: RobotDescription, seed: int) -> np.ndarray:
    lower = np.concatenate((robot.arm_lower_limits, robot.hand_lower_limits))
    upper = np.concatenate((robot.arm_upper_limits, robot.hand_upper_limits))
    return np.random.default_rng(seed).uniform(lower, upper)


def test_stands_upright_at_its_published_height(robot: RobotDescription, frames: Frames) -> None:
    flange = frames(np.zeros(23))["lbr4_7_link"]
    np.testing.assert_allclose(flange[:3, 3], [0, 0, sum(DH_DISTANCES_M.values())], atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_joint_centres_keep_the_dh_distances(robot: RobotDescription, frames: Frames, seed: int) -> None:
    poses = frames(random_angles(robot, seed))
    for (first, second), distance in DH_DISTANCES_M.items():
        apart = np.linalg.norm(poses[first][:3, 3] - poses[second][:3, 3])
        assert apart == pytest.approx(distance, abs=1e-9)


def test_hand_sits_on_its_mount(settings: RobotSettings, robot: RobotDescription, frames: Frames) -> None:
    poses = frames(random_angles(robot, 0))
    T_flange_palm = np.linalg.inv(poses["lbr4_7_link"]) @ poses[robot.palm_link]
    np.testing.assert_allclose(T_flange_palm[:3, 3], [0, 0, settings.mount_length_m + 0.095], atol=1e-9)
    np.testing.assert_allclose(T_flange_palm[:3, 2], [0, 0, 1], atol=1e-9)


def test_palm_frame_points_as_theta_says(robot: RobotDescription, frames: Frames) -> None:
    poses = frames(np.zeros(23))
    T_base_palm = poses[robot.palm_link] @ robot.T_link_palm
    tips = {
        finger: (np.linalg.inv(T_base_palm) @ poses[link])[:3, 3]
        for finger, link in robot.fingertip_links.items()
    }
    assert tips["middle"][2] > 0.12
    assert tips["thumb"][1] > tips["middle"][1] > tips["ring"][1]
    bent = np.concatenate((np.zeros(7), [0, 1, 0, 0] * 3 + [0] * 4))
    middle = (np.linalg.inv(T_base_palm) @ frames(bent)[robot.fingertip_links["middle"]])[:3, 3]
    assert middle[0] > 0.05


def test_simulator_sees_23_joints_and_the_same_kinematics(
    robot: RobotDescription, frames: Frames, articulation: sapien.physx.PhysxArticulation
) -> None:
    angles = dict(zip(robot.arm_joints + robot.hand_joints, random_angles(robot, 1), strict=True))
    active = [joint.name for joint in articulation.active_joints]
    assert len(active) == 23
    assert set(active) == set(angles)
    articulation.set_qpos(np.array([angles[name] for name in active], np.float32))
    poses = frames(np.array(list(angles.values())))
    for name in (robot.palm_link, *robot.fingertip_links.values()):
        seen = articulation.find_link_by_name(name).entity_pose.to_transformation_matrix()
        np.testing.assert_allclose(seen, robot.T_world_base @ poses[name], atol=1e-5)


def test_masses_and_inertias_can_exist(articulation: sapien.physx.PhysxArticulation) -> None:
    assert 14 < sum(link.mass for link in articulation.links) < 18
    for link in articulation.links:
        moments = np.sort(link.inertia)
        assert link.mass > 0
        assert moments[0] > 0
        assert moments[2] <= moments[0] + moments[1] + 1e-9


def test_pedestal_stands_on_the_floor(robot: RobotDescription) -> None:
    model = pin.buildModelFromUrdf(str(robot.urdf_path))
    shapes = pin.buildGeomFromUrdf(model, str(robot.urdf_path), pin.GeometryType.COLLISION)
    bottom = min(
        shape.placement.translation[2] - shape.geometry.halfLength
        for shape in shapes.geometryObjects
        if shape.name.startswith("lbr4_base_link")
    )
    assert robot.T_world_base[2, 3] + bottom == pytest.approx(0.0, abs=1e-6)


def test_arm_links_are_capsules_for_collision_checks(robot: RobotDescription) -> None:
    model = pin.buildModelFromUrdf(str(robot.urdf_path))
    shapes = pin.buildGeomFromUrdf(model, str(robot.urdf_path), pin.GeometryType.COLLISION)
    kinds = {shape.name: type(shape.geometry).__name__ for shape in shapes.geometryObjects}
    assert all(kinds[f"lbr4_{k}_link_0"] == "Capsule" for k in range(1, 6))
    assert not {"BVHModelOBBRSS", "BVHModelBase"} & set(kinds.values())


def test_fingers_have_real_torques_and_four_joints(settings: RobotSettings, robot: RobotDescription) -> None:
    model = pin.buildModelFromUrdf(str(robot.urdf_path))
    for joints in robot.fingers.values():
        assert len(joints) == 4
        for name in joints:
            index = model.joints[model.getJointId(name)].idx_v
            assert model.effortLimit[index] == pytest.approx(settings.hand_torque_limit)
    assert sum(robot.fingers.values(), ()) == robot.hand_joints


def test_rests_within_its_limits(robot: RobotDescription) -> None:
    assert np.all((robot.arm_home > robot.arm_lower_limits) & (robot.arm_home < robot.arm_upper_limits))
    assert np.all((robot.hand_open >= robot.hand_lower_limits) & (robot.hand_open <= robot.hand_upper_limits))


def test_configured_ranges_lie_within_the_hand(robot_config: DictConfig, robot: RobotDescription) -> None:
    space = robot.grasp_space
    for limits in (space.lower[6:], space.upper[6:]):
        np.testing.assert_allclose(robot.preshape_joints(robot.preshape(limits)), limits)
    for name, (low, high) in robot_config.robot.heuristic.joint_ranges.items():
        k = space.names.index(name)
        assert space.lower[k] <= low <= high <= space.upper[k]


def test_preshape_sets_two_joints_per_finger_and_clips(robot: RobotDescription) -> None:
    hand = dict(zip(robot.hand_joints, robot.preshape(np.full(8, 0.4)), strict=True))
    for finger, joints in robot.fingers.items():
        assert [hand[name] for name in joints] == [0.4, 0.4, 0.0, 0.0], finger
    np.testing.assert_array_equal(robot.preshape_joints(robot.preshape(np.full(8, 9.0)))[0], 0.47)


def test_same_settings_give_the_same_untouched_file(
    settings: RobotSettings, robot: RobotDescription, tmp_path: Path
) -> None:
    first = load_robot(settings, robot.grasp_space, tmp_path)
    written = first.urdf_path.stat().st_mtime_ns
    assert load_robot(settings, robot.grasp_space, tmp_path).urdf_path == first.urdf_path
    assert first.urdf_path.stat().st_mtime_ns == written
    taller = load_robot(replace(settings, base_height_m=0.7), robot.grasp_space, tmp_path)
    assert taller.urdf_path != first.urdf_path
    assert len(list((tmp_path / "robots").iterdir())) == 2


@pytest.mark.parametrize(
    "change",
    [
        {"arm_home_rad": (0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0)},
        {"arm_home_rad": (0.0, 0.0)},
        {"arm_accelerations": (1.0,)},
        {"preshape_mapping": {"index_0": "joint_0.0"}},
        {"hand_open_rad": {"joint_99.0": 0.1}},
    ],
)
def test_settings_that_do_not_fit_are_refused(
    settings: RobotSettings, robot: RobotDescription, tmp_path: Path, change: dict[str, object]
) -> None:
    with pytest.raises(InputError, match=r"robot=lbr4_allegro"):
        load_robot(replace(settings, **change), robot.grasp_space, tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_missing_hand_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(allegro, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"requirements\.lock"):
        allegro.load_hand(0.7)


def test_a_broken_hand_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    urdf = tmp_path / "allegro_hand_description" / "urdf" / "allegro_right_hand.urdf"
    urdf.parent.mkdir(parents=True)
    urdf.write_text('<robot><link name="palm_link"><visual><geometry><mesh filename="package://a.STL"/>')
    monkeypatch.setattr(allegro, "_robots_folder", lambda: tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        allegro.load_hand(0.7)
    urdf.write_text(urdf.read_text() + "</geometry></visual></link></robot>")
    with pytest.raises(InputError, match="mesh of the Allegro hand is missing"):
        allegro.load_hand(0.7)
