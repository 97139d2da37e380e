"""Whole motions: free, within limits, straight where they should be, the same for the same seed."""

import hashlib
import multiprocessing
import re
from itertools import product

import numpy as np
import pytest

from preshape.data.trial import TrialOutcome
from sim.arm.planner import ArmPlanner
from sim.arm.trajectory import GraspMotion, JointTrajectory, MotionFailure
from sim.robots.description import RobotDescription
from sim.table import TableSettings

TABLE = TableSettings()
PRESHAPE = np.array([0.1, 0.05, 0.0, 0.0, -0.1, 0.05, 1.396, 0.5])
SIDE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]).T
TOP = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]).T
UP = np.array([0.0, 0.0, 1.0])


def pose(rotation: np.ndarray, position: tuple[float, float, float]) -> np.ndarray:
    T_world_palm = np.eye(4)
    T_world_palm[:3, :3], T_world_palm[:3, 3] = rotation, position
    return T_world_palm


def standing_box(size: tuple[float, float, float], x: float, y: float) -> np.ndarray:
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * size
    return corners + np.array([x, y, TABLE.top_m + size[2] / 2])


GRASPS = {
    "side": (pose(SIDE, (0.78, -0.06, 0.69)), standing_box((0.07, 0.07, 0.2), 0.8, 0.005)),
    "top": (pose(TOP, (0.78, 0.0, 0.77)), standing_box((0.07, 0.07, 0.16), 0.8, 0.0)),
}


@pytest.fixture(scope="module")
def planner(robot: RobotDescription) -> ArmPlanner:
    return ArmPlanner(robot, TABLE)


@pytest.fixture(scope="module", params=list(GRASPS))
def query(request: pytest.FixtureRequest) -> tuple[np.ndarray, np.ndarray]:
    return GRASPS[request.param]


def plan(
    planner: ArmPlanner, robot: RobotDescription, T_world_palm: np.ndarray, *parts: np.ndarray, seed: int = 0
) -> GraspMotion | MotionFailure:
    preshape = robot.preshape(PRESHAPE)
    return planner.plan_grasp(T_world_palm, preshape, parts, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def motion(planner: ArmPlanner, robot: RobotDescription, query: tuple[np.ndarray, np.ndarray]) -> GraspMotion:
    motion = plan(planner, robot, *query)
    assert isinstance(motion, GraspMotion), motion
    return motion


def finely(trajectory: JointTrajectory) -> tuple[np.ndarray, np.ndarray]:
    """Joint angles and velocities every 2 ms."""
    times = np.arange(0.0, trajectory.duration_s, 0.002)
    return trajectory.sample(times)


def parts_of(motion: GraspMotion) -> tuple[JointTrajectory, JointTrajectory, JointTrajectory]:
    return motion.transit, motion.approach, motion.lift


def test_parts_join_from_rest_to_the_lifted_grasp(
    planner: ArmPlanner, robot: RobotDescription, motion: GraspMotion, query: tuple[np.ndarray, np.ndarray]
) -> None:
    T_world_palm, _ = query
    np.testing.assert_allclose(motion.transit.positions[0], robot.arm_home, atol=1e-9)
    np.testing.assert_allclose(motion.transit.positions[-1], motion.approach.positions[0], atol=1e-6)
    np.testing.assert_allclose(motion.approach.positions[-1], motion.lift.positions[0], atol=1e-6)
    reached = planner.kinematics.palm_pose(motion.approach.positions[-1])
    np.testing.assert_allclose(reached[:3, 3], T_world_palm[:3, 3], atol=1e-4)
    np.testing.assert_allclose(reached[:3, :3], T_world_palm[:3, :3], atol=1e-3)
    lifted = planner.kinematics.palm_pose(motion.lift.positions[-1])
    np.testing.assert_allclose(lifted[:3, 3], T_world_palm[:3, 3] + 0.15 * UP, atol=1e-4)


def test_parts_start_and_end_at_rest(motion: GraspMotion) -> None:
    for part in parts_of(motion):
        np.testing.assert_allclose(part.velocities[[0, -1]], 0.0, atol=1e-6)


def test_limits_are_kept(robot: RobotDescription, motion: GraspMotion) -> None:
    for part in parts_of(motion):
        positions, velocities = finely(part)
        assert np.all((positions > robot.arm_lower_limits) & (positions < robot.arm_upper_limits))
        assert np.all(np.abs(velocities) < 1.02 * robot.arm_velocities)
        accelerations = np.gradient(velocities, 0.002, axis=0)
        # Between its samples the cubic overshoots the piecewise constant accelerations a little.
        assert np.quantile(np.abs(accelerations) / robot.arm_accelerations, 0.99) < 1.3


def test_motion_is_free_at_a_fine_resolution(
    planner: ArmPlanner, robot: RobotDescription, motion: GraspMotion, query: tuple[np.ndarray, np.ndarray]
) -> None:
    checker = planner.checker(robot.preshape(PRESHAPE), query[1:])
    assert all(checker.is_clear(positions) for positions in finely(motion.transit)[0])
    assert all(checker.is_free_but_for_hand_on_object(p) for p in finely(motion.approach)[0])
    assert all(checker.is_free(positions) for positions in finely(motion.lift)[0])


@pytest.mark.parametrize("line", ["approach", "lift"])
def test_lines_are_straight_and_slow(
    planner: ArmPlanner, motion: GraspMotion, query: tuple[np.ndarray, np.ndarray], line: str
) -> None:
    direction, length, speed = (query[0][:3, 0], 0.1, 0.1) if line == "approach" else (UP, 0.15, 0.05)
    trajectory = getattr(motion, line)
    palms = np.array([planner.kinematics.palm_pose(p)[:3, 3] for p in finely(trajectory)[0]])
    along = (palms - palms[0]) @ direction
    off_line = palms - palms[0] - along[:, None] * direction
    assert np.linalg.norm(off_line, axis=1).max() < 1e-3
    assert np.ptp(along) == pytest.approx(length, abs=1e-3)
    assert np.gradient(along, 0.002).max() == pytest.approx(speed, rel=0.05)


@pytest.mark.parametrize(
    ("T_world_palm", "part", "outcome", "reason"),
    [
        pytest.param(
            pose(SIDE, (1.5, 0.0, 0.8)),
            GRASPS["side"][1],
            TrialOutcome.UNREACHABLE,
            "no arm configuration",
            id="too far",
        ),
        pytest.param(
            pose(TOP @ np.diag([1.0, -1.0, -1.0]), (0.9, 0.0, 0.8)),
            GRASPS["top"][1],
            TrialOutcome.UNREACHABLE,
            "no arm configuration",
            id="fingers towards the robot",
        ),
        pytest.param(
            pose(SIDE, (0.8, -0.05, TABLE.top_m + 0.03)),
            GRASPS["side"][1],
            TrialOutcome.BLOCKED,
            "the hand collides: .* table",
            id="hand in the table",
        ),
        pytest.param(
            pose(SIDE, (0.78, 0.0, 0.69)),
            GRASPS["side"][1],
            TrialOutcome.BLOCKED,
            "the hand collides: .* object",
            id="hand in the object",
        ),
        pytest.param(
            GRASPS["side"][0],
            standing_box((0.5, 0.02, 0.5), 0.8, -0.16),
            TrialOutcome.BLOCKED,
            "approach|pre-grasp",
            id="wall behind the hand",
        ),
    ],
)
def test_failures_say_why(
    planner: ArmPlanner,
    robot: RobotDescription,
    T_world_palm: np.ndarray,
    part: np.ndarray,
    outcome: TrialOutcome,
    reason: str,
) -> None:
    failure = plan(planner, robot, T_world_palm, part)
    assert isinstance(failure, MotionFailure)
    assert failure.outcome is outcome
    assert not outcome.executed
    assert re.search(reason, failure.reason), failure.reason


def test_crossed_fingers_are_blocked(planner: ArmPlanner, robot: RobotDescription) -> None:
    crossed = robot.preshape(np.array([-0.47, 0.7, 0.47, 0.7, 0.0, 0.7, 1.0, 0.5]))
    failure = planner.plan_grasp(GRASPS["side"][0], crossed, [], np.random.default_rng(0))
    assert isinstance(failure, MotionFailure)
    assert failure.outcome is TrialOutcome.BLOCKED
    assert "fingers overlap" in failure.reason


def digest(motion: GraspMotion | MotionFailure) -> str:
    assert isinstance(motion, GraspMotion)
    arrays = [a for part in parts_of(motion) for a in (part.times, part.positions, part.velocities)]
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


def digests(robot: RobotDescription, *queries: tuple[str, int]) -> list[str]:
    planner = ArmPlanner(robot, TABLE)
    return [digest(plan(planner, robot, *GRASPS[name], seed=seed)) for name, seed in queries]


def test_same_seed_gives_the_same_motion_in_any_order(robot: RobotDescription) -> None:
    queries = list(product(GRASPS, (1, 2)))
    forwards, backwards = digests(robot, *queries), digests(robot, *reversed(queries))
    assert forwards == backwards[::-1]
    assert len(set(forwards)) == len(queries)


def test_same_seed_gives_the_same_motion_in_another_process(robot: RobotDescription) -> None:
    context = multiprocessing.get_context("spawn")
    with context.Pool(1) as pool:
        assert pool.apply(digests, (robot, ("side", 1), ("top", 2))) == digests(
            robot, ("side", 1), ("top", 2)
        )


def test_times_are_reported(motion: GraspMotion) -> None:
    times = motion.times
    assert 0 < times.inverse_kinematics_s < 5
    assert 0 < times.path_s < 5
    assert 0 < times.timing_s < 5
