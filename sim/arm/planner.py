"""Plans the arm's whole motion to a grasp: free transit, straight approach, straight lift."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from preshape.data.trial import TrialOutcome
from sim.arm.candidates import Candidate, CandidateSearch, LineSettings, NoMotionError
from sim.arm.collision import CollisionChecker, HandOverlap
from sim.arm.inverse_kinematics import InverseKinematics, InverseKinematicsSettings
from sim.arm.kinematics import ArmKinematics, RobotModel
from sim.arm.path import PathSettings, find_path
from sim.arm.timing import JointLimits, fastest_trajectory, line_trajectory
from sim.arm.trajectory import GraspMotion, JointTrajectory, MotionFailure, PlanningTimes
from sim.robots.description import RobotDescription
from sim.table import TableSettings


@dataclass(frozen=True)
class ArmPlannerSettings:
    """How the arm moves to a grasp.

    Args:
        approach_speed_m_s, lift_speed_m_s: the palm's speeds on the straight lines.
        line_acceleration_m_s2: the palm's acceleration on them.
        clearance_m: distance that the transit keeps from the object.
        allowed_depth_m: how deep the hand may be in the object at the grasp pose; physics settles the rest.
        attempts: searches for a free path per grasp.
        verification_rad: distance of the configurations at which a finished transit is checked again.
        lines, inverse_kinematics, path: settings of the parts.
    """

    approach_speed_m_s: float = 0.1
    lift_speed_m_s: float = 0.05
    line_acceleration_m_s2: float = 0.5
    clearance_m: float = 0.01
    allowed_depth_m: float = 0.01
    attempts: int = 3
    verification_rad: float = 0.02
    lines: LineSettings = field(default_factory=LineSettings)
    inverse_kinematics: InverseKinematicsSettings = field(default_factory=InverseKinematicsSettings)
    path: PathSettings = field(default_factory=PathSettings)


class _Clock:
    """Sums up wall-clock seconds by part."""

    def __init__(self) -> None:
        self._seconds: dict[str, float] = {}

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Book the time that the body takes."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self._seconds[name] = self._seconds.get(name, 0.0) + time.perf_counter() - start

    def times(self) -> PlanningTimes:
        """What was booked."""
        return PlanningTimes(**self._seconds)


DEFAULTS = ArmPlannerSettings()


class ArmPlanner:
    """Plans motions of one robot at one table.

    An answer is a function of the query and the state of its `rng` alone, to the bit: nothing is bounded by
    time. OMPL's generators are global, so the queries of one process must not overlap.

    Args:
        robot: the robot.
        table: where the object stands.
        settings: how to move.
    """

    def __init__(
        self, robot: RobotDescription, table: TableSettings, settings: ArmPlannerSettings = DEFAULTS
    ) -> None:
        self._table, self._settings = table, settings
        self._model = RobotModel(robot)
        self.kinematics = ArmKinematics(self._model)
        self._inverse = InverseKinematics(self.kinematics, settings.inverse_kinematics)
        self._limits = JointLimits(robot.arm_velocities, robot.arm_accelerations)
        self._home = robot.arm_home
        self._hand_overlap = HandOverlap(self._model)

    def plan_grasp(
        self,
        T_world_palm: Float[np.ndarray, "4 4"],
        hand_preshape: Float[np.ndarray, "h"],
        object_parts: Sequence[Float[np.ndarray, "_ 3"]],
        rng: np.random.Generator,
    ) -> GraspMotion | MotionFailure:
        """Motion from rest to a grasp pose, and from there straight up.

        Args:
            T_world_palm: where the palm is to be.
            hand_preshape: joint angles of the hand (rad), the same all the way.
            object_parts: vertices of the object's convex parts (m, world).
            rng: source of random starts.
        """
        clock = _Clock()
        try:
            with clock.part("inverse_kinematics_s"):
                self._check_preshape(hand_preshape)
                checker = self.checker(hand_preshape, object_parts)
                search = CandidateSearch(self._inverse, checker, self._settings.lines)
                candidates = search.candidates(T_world_palm, rng)
            transit, candidate = self._transit(candidates, checker, rng, clock)
            with clock.part("timing_s"):
                lines, settings = self._settings.lines, self._settings
                approach = self._line(candidate.approach, lines.approach_m, settings.approach_speed_m_s)
                lift = self._line(candidate.lift, lines.lift_m, settings.lift_speed_m_s)
            return GraspMotion(transit, approach, lift, clock.times())
        except NoMotionError as error:
            return MotionFailure(error.outcome, error.reason, clock.times())

    def checker(
        self, hand_preshape: Float[np.ndarray, "h"], object_parts: Sequence[Float[np.ndarray, "_ 3"]]
    ) -> CollisionChecker:
        """The collision checks that a query makes."""
        return CollisionChecker(
            self._model,
            hand_preshape,
            self._table,
            object_parts,
            clearance_m=self._settings.clearance_m,
            allowed_depth_m=self._settings.allowed_depth_m,
        )

    def _check_preshape(self, hand: Float[np.ndarray, "h"]) -> None:
        overlap = self._hand_overlap(hand)
        if overlap is not None:
            raise NoMotionError(TrialOutcome.BLOCKED, f"fingers overlap in the preshape: {overlap}")

    def _transit(
        self,
        candidates: list[Candidate],
        checker: CollisionChecker,
        rng: np.random.Generator,
        clock: _Clock,
    ) -> tuple[JointTrajectory, Candidate]:
        """Free motion from rest to the start of one candidate's approach; near candidates come first."""
        kinematics, settings = self.kinematics, self._settings
        ranked = sorted(candidates, key=lambda candidate: np.abs(candidate.approach[0] - self._home).max())
        for attempt in range(settings.attempts):
            candidate, seed = ranked[attempt % len(ranked)], int(rng.integers(1, 2**31))
            with clock.part("path_s"):
                limits = (kinematics.lower, kinematics.upper)
                goal = candidate.approach[0]
                path = find_path(self._home, goal, checker.is_clear, limits, settings.path, seed)
            with clock.part("timing_s"):
                transit = None if path is None else fastest_trajectory(path, self._limits)
                if transit is not None and self._is_clear(transit, checker):
                    return transit, candidate
        raise NoMotionError(TrialOutcome.BLOCKED, "no free path leads to the pre-grasp pose")

    def _is_clear(self, transit: JointTrajectory, checker: CollisionChecker) -> bool:
        """Smoothing and timing move a path a little, so its finished form is checked again, finely."""
        finely = transit.spaced_positions(self._settings.verification_rad)
        return all(checker.is_clear(positions) for positions in finely)

    def _line(
        self, waypoints: Float[np.ndarray, "n a"], length_m: float, speed_m_s: float
    ) -> JointTrajectory:
        acceleration = self._settings.line_acceleration_m_s2
        motion = line_trajectory(waypoints, length_m, speed_m_s, acceleration, self._limits)
        if motion is None:
            raise NoMotionError(TrialOutcome.BLOCKED, "the joints are too slow for a straight line")
        return motion
