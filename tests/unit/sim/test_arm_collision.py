"""Collision checks see the robot itself, the table, the floor and the object, each with its own margin."""

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest

from sim.arm.collision import CollisionChecker, HandOverlap
from sim.arm.inverse_kinematics import InverseKinematics, InverseKinematicsSettings
from sim.arm.kinematics import ArmKinematics, RobotModel
from sim.robots.description import RobotDescription
from sim.table import TableSettings

TABLE = TableSettings()
PALM_OVER_TABLE = np.array(
    [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
).T  # x: +y, y: +z, z: +x of the world
AWAY = np.array([0.0, 1.0, 0.0])
PALM_SURFACE_M = 0.0117
"""Distance of the palm's collision boxes from the palm frame along its normal."""


def box(size: tuple[float, float, float], centre: np.ndarray) -> np.ndarray:
    return np.array(list(product((-0.5, 0.5), repeat=3))) * size + centre


@pytest.fixture(scope="module")
def model(robot: RobotDescription) -> RobotModel:
    return RobotModel(robot)


@pytest.fixture(scope="module")
def arm_at(model: RobotModel) -> Callable[[np.ndarray], np.ndarray]:
    """Arm joint angles that put the palm, thumb up and fingers forward, at a position."""
    inverse = InverseKinematics(ArmKinematics(model), InverseKinematicsSettings())

    def at(position: np.ndarray) -> np.ndarray:
        pose = PALM_OVER_TABLE.copy()
        pose[:3, 3] = position
        free = check(model)
        return next(q for q in inverse.solutions(pose, np.random.default_rng(0)) if free.is_free(q))

    return at


def check(model: RobotModel, *parts: np.ndarray) -> CollisionChecker:
    return CollisionChecker(
        model, model.robot.hand_open, TABLE, parts, clearance_m=0.01, allowed_depth_m=0.01
    )


def test_rest_is_clear(model: RobotModel) -> None:
    assert check(model).is_clear(model.robot.arm_home)


def test_arm_hits_itself(model: RobotModel) -> None:
    folded = np.array([0.0, 0.0, 0.0, 2.09, 0.0, -2.09, 0.0])
    assert check(model).obstruction(folded) is not None
    assert not check(model).is_free(folded)


@pytest.mark.parametrize(("shoulder", "elbow", "obstacle"), [(-1.9, 0.0, "table"), (2.09, -0.9, "floor")])
def test_arm_hits_its_surroundings(model: RobotModel, shoulder: float, elbow: float, obstacle: str) -> None:
    positions = np.array([0.0, shoulder, 0.0, elbow, 0.0, 0.0, 0.0])
    assert not check(model).is_free(positions)
    assert obstacle in str(check(model).obstruction(positions))


@pytest.mark.parametrize(
    ("gap", "clear", "reported"), [(0.012, True, False), (0.008, False, False), (-0.012, False, True)]
)
def test_object_is_kept_clear_of_and_may_be_touched_but_not_entered(
    model: RobotModel, arm_at: Callable[[np.ndarray], np.ndarray], gap: float, clear: bool, reported: bool
) -> None:
    palm = np.array([0.75, 0.0, 0.75])
    size = (0.02, 0.1, 0.04)
    # Before the palm's lower half only, so that the spread fingers and the thumb stay away from it.
    part = box(size, palm + AWAY * (PALM_SURFACE_M + gap + size[1] / 2) + [-0.02, 0.0, 0.0])
    checker, positions = check(model, part), arm_at(palm)
    assert checker.is_clear(positions) is clear
    assert (checker.hand_obstruction(positions) is not None) is reported
    assert checker.is_free_but_for_hand_on_object(positions)


def test_arm_may_not_touch_the_object(model: RobotModel, arm_at: Callable[[np.ndarray], np.ndarray]) -> None:
    palm = np.array([0.75, 0.0, 0.75])
    positions = arm_at(palm)
    wrist = palm - [0.25, 0.0, 0.0]
    checker = check(model, box((0.05, 0.05, 0.05), wrist))
    assert checker.is_free(positions)
    assert not checker.is_free_but_for_hand_on_object(positions)
    assert checker.hand_obstruction(positions) is None


def test_hand_in_the_table_is_the_hands_fault(
    model: RobotModel, arm_at: Callable[[np.ndarray], np.ndarray]
) -> None:
    inverse = InverseKinematics(ArmKinematics(model), InverseKinematicsSettings())
    pose = PALM_OVER_TABLE.copy()
    pose[:3, 3] = [0.8, 0.0, TABLE.top_m + 0.03]
    positions = next(inverse.solutions(pose, np.random.default_rng(0)))
    assert "table" in str(check(model).hand_obstruction(positions))


def test_every_convex_part_counts(model: RobotModel, arm_at: Callable[[np.ndarray], np.ndarray]) -> None:
    palm = np.array([0.75, 0.0, 0.75])
    far, near = box((0.1, 0.1, 0.1), palm + np.array([0.0, 0.5, 0.0])), box((0.1, 0.1, 0.1), palm)
    assert not check(model, far, near).is_clear(arm_at(palm))
    assert check(model, far).is_clear(arm_at(palm))


def test_bounding_boxes_change_no_answer(model: RobotModel) -> None:
    robot, rng = model.robot, np.random.default_rng(0)
    checker = check(model, box((0.2, 0.2, 0.3), np.array([0.6, 0.0, 0.9])))
    angles = rng.uniform(robot.arm_lower_limits, robot.arm_upper_limits, (500, 7))
    answers = [checker.is_clear(positions) for positions in angles]
    assert answers == [checker.obstruction(positions) is None for positions in angles]
    assert 50 < sum(answers) < 490


def test_fingers_that_cross_overlap(model: RobotModel) -> None:
    overlap, robot = HandOverlap(model), model.robot
    assert overlap(robot.hand_open) is None
    crossed = robot.preshape(np.array([-0.47, 0.7, 0.47, 0.7, 0.0, 0.7, 1.0, 0.5]))
    assert overlap(crossed) is not None
