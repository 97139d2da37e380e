"""The gripper on the arm: how far it opens, how its fingers move together, and which way its frame points."""

import numpy as np
import pinocchio as pin
import pytest
import sapien
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.errors import InputError
from preshape.paths import project_root
from sim.physics import PhysicsSettings, make_scene
from sim.robots.description import RobotDescription
from sim.robots.parallel_gripper import STROKE_M, ParallelGripper
from sim.simulated_robot import SimulatedRobot


@pytest.fixture(scope="module")
def gripper() -> ParallelGripper:
    return ParallelGripper(3)


@pytest.fixture(scope="module")
def baxter(tmp_path_factory: pytest.TempPathFactory) -> RobotDescription:
    """The robot of conf/robot/baxter.yaml."""
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("collect", ["robot=baxter", f"paths.cache={tmp_path_factory.mktemp('cache')}"])
        return instantiate(cfg.robot.description)


def finger_boxes(robot: RobotDescription, closed_by_m: float) -> dict[str, np.ndarray]:
    """Corners (palm frame) of each finger's shapes: finger -> n 3."""
    model = pin.buildModelFromUrdf(str(robot.urdf_path))
    shapes = pin.buildGeomFromUrdf(model, str(robot.urdf_path), pin.GeometryType.COLLISION)
    positions = pin.neutral(model)
    for name in robot.hand_joints:
        positions[model.joints[model.getJointId(name)].idx_q] = closed_by_m
    data, shape_data = model.createData(), shapes.createData()
    pin.updateGeometryPlacements(model, data, shapes, shape_data, positions)
    pin.framesForwardKinematics(model, data, positions)
    T_base_link = data.oMf[model.getFrameId(robot.palm_link)].homogeneous
    T_palm_base = np.linalg.inv(T_base_link @ robot.T_link_palm)
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    corners: dict[str, list[np.ndarray]] = {}
    for shape, placed in zip(shapes.geometryObjects, shape_data.oMg, strict=True):
        link = model.frames[shape.parentFrame].name
        if link.endswith("_finger"):
            in_base = signs * shape.geometry.halfSide @ placed.rotation.T + placed.translation
            corners.setdefault(link, []).append(in_base @ T_palm_base[:3, :3].T + T_palm_base[:3, 3])
    return {link: np.concatenate(parts) for link, parts in corners.items()}


@pytest.mark.parametrize("closed_by_m", [0.0, 0.01, STROKE_M])
def test_the_paddles_are_as_far_apart_as_said(
    baxter: RobotDescription, gripper: ParallelGripper, closed_by_m: float
) -> None:
    boxes = finger_boxes(baxter, closed_by_m)
    ends = {link: corners[corners[:, 0] > -0.05] for link, corners in boxes.items()}
    gap = ends["left_finger"][:, 1].min() - ends["right_finger"][:, 1].max()
    assert gap == pytest.approx(gripper.opening(closed_by_m), abs=1e-5)
    assert gripper.closed_by(gap) == pytest.approx(closed_by_m, abs=1e-5)
    farthest = max(corners[:, 0].max() for corners in boxes.values())
    assert farthest == pytest.approx(0.0, abs=1e-5)


def test_it_opens_to_about_eight_centimetres(gripper: ParallelGripper) -> None:
    assert gripper.widest_m == pytest.approx(0.077, abs=5e-4)
    assert gripper.narrowest_m == pytest.approx(0.035, abs=5e-4)
    assert gripper.closed_by(1.0) == 0.0
    assert gripper.closed_by(0.0) == STROKE_M


def test_one_motor_moves_both_fingers(baxter: RobotDescription) -> None:
    scene = make_scene(PhysicsSettings(), rendered=False)
    robot = SimulatedRobot(scene, baxter)
    robot.place(baxter.arm_home, np.zeros(2))
    joints = {joint.name: joint for joint in robot.articulation.active_joints}
    # whatever pushes one finger, pushes the other
    joints["right_finger_joint"].set_drive_properties(0.0, 0.0, 0.0)
    for _ in range(120):
        joints["left_finger_joint"].set_drive_target(0.015)
        scene.step()
    np.testing.assert_allclose(robot.hand_positions, 0.015, atol=1e-4)
    assert all(link.mass > 0 and link.inertia.min() > 0 for link in robot.articulation.links)
    assert isinstance(robot.articulation, sapien.physx.PhysxArticulation)


def test_a_slot_that_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="slot 7"):
        ParallelGripper(7)
