"""Inverse kinematics reaches poses and follows lines, within the joint limits."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.arm.inverse_kinematics import InverseKinematics, InverseKinematicsSettings
from sim.arm.kinematics import ArmKinematics, RobotModel
from sim.robots.description import RobotDescription

UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def kinematics(robot: RobotDescription) -> ArmKinematics:
    return ArmKinematics(RobotModel(robot))


@pytest.fixture(scope="module")
def inverse(kinematics: ArmKinematics) -> InverseKinematics:
    return InverseKinematics(kinematics, InverseKinematicsSettings())


def reachable_pose(kinematics: ArmKinematics, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return kinematics.palm_pose(rng.uniform(0.6 * kinematics.lower, 0.6 * kinematics.upper))


@pytest.mark.parametrize("seed", range(5))
def test_solutions_reach_the_pose_within_the_limits(
    kinematics: ArmKinematics, inverse: InverseKinematics, seed: int
) -> None:
    target = reachable_pose(kinematics, seed)
    solutions = list(inverse.solutions(target, np.random.default_rng(seed)))
    assert len(solutions) >= 2
    for solution in solutions:
        reached = kinematics.palm_pose(solution)
        assert np.linalg.norm(reached[:3, 3] - target[:3, 3]) < 1e-4
        turn = Rotation.from_matrix(reached[:3, :3].T @ target[:3, :3]).magnitude()
        assert turn < 1e-3
        assert np.all((solution > kinematics.lower) & (solution < kinematics.upper))


def test_solutions_differ(kinematics: ArmKinematics, inverse: InverseKinematics) -> None:
    solutions = list(inverse.solutions(reachable_pose(kinematics, 0), np.random.default_rng(0)))
    for i, first in enumerate(solutions):
        assert all(np.abs(first - second).max() > 0.3 for second in solutions[:i])


def test_same_generator_gives_the_same_solutions(
    kinematics: ArmKinematics, inverse: InverseKinematics
) -> None:
    pose = reachable_pose(kinematics, 1)
    first = list(inverse.solutions(pose, np.random.default_rng(3)))
    np.testing.assert_array_equal(first, list(inverse.solutions(pose, np.random.default_rng(3))))


def test_out_of_reach_has_no_solution(kinematics: ArmKinematics, inverse: InverseKinematics) -> None:
    pose = reachable_pose(kinematics, 0)
    pose[:3, 3] = [1.6, 0.0, 0.8]
    assert not list(inverse.solutions(pose, np.random.default_rng(0)))


def test_jacobian_agrees_with_finite_differences(kinematics: ArmKinematics) -> None:
    rng = np.random.default_rng(0)
    positions = rng.uniform(0.6 * kinematics.lower, 0.6 * kinematics.upper)
    target = kinematics.link_target(kinematics.palm_pose(positions))
    error, jacobian = kinematics.error_and_jacobian(target, positions)
    np.testing.assert_allclose(error, 0, atol=1e-9)
    for k, step in enumerate(1e-6 * np.eye(7)):
        moved, _ = kinematics.error_and_jacobian(target, positions + step)
        np.testing.assert_allclose(-moved / 1e-6, jacobian[:, k], atol=1e-4)


def test_lines_are_straight_and_do_not_turn_the_palm(
    kinematics: ArmKinematics, inverse: InverseKinematics
) -> None:
    start = np.array([0.3, -0.6, 0.2, 1.4, 0.1, -0.7, 0.4])
    pose = kinematics.palm_pose(start)
    line = inverse.line(start, UP, 0.15, 0.005)
    assert line is not None
    assert len(line) == 31
    for travelled, positions in zip(np.linspace(0, 0.15, 31), line, strict=True):
        reached = kinematics.palm_pose(positions)
        np.testing.assert_allclose(reached[:3, 3], pose[:3, 3] + travelled * UP, atol=1e-4)
        np.testing.assert_allclose(reached[:3, :3], pose[:3, :3], atol=1e-3)


def test_a_line_out_of_reach_ends_in_none(inverse: InverseKinematics) -> None:
    assert inverse.line(np.array([0.0, 0.1, 0.0, 0.2, 0.0, -0.1, 0.0]), UP, 0.5, 0.02) is None
