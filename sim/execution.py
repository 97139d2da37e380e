"""Executing one planned grasp: approach, close, lift, hold; and measuring what happened."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

import numpy as np
from jaxtyping import Float

from preshape.data.trial import GraspType
from sim.arm.trajectory import GraspMotion, JointTrajectory
from sim.closing import Closing, ClosingController, ClosingSettings
from sim.outcome import Measurements
from sim.physics import PhysicsSettings
from sim.world import World


@dataclass(frozen=True)
class ExecutionSettings:
    """How a grasp is executed.

    Args:
        control_period_s: time between two updates of the drives' targets.
        settle_time_s: pause between approach and closing, and again between closing and lifting.
        hold_time_s: how long the hand holds the object up before the trial is judged.
        lost_lag_m: the trial ends early when the object has stayed so far behind the rising palm, does not
            rise and is not touched by the hand: it is lost, and the outcome decided. None for never.
        closing: how the hand closes.
    """

    control_period_s: float = 1 / 60
    settle_time_s: float = 0.15
    hold_time_s: float = 0.6
    lost_lag_m: float | None = 0.05
    closing: Closing = field(default_factory=ClosingSettings)


@dataclass(frozen=True, eq=False)
class Execution:
    """What came of a grasp.

    Args:
        T_world_palm: the palm pose that the robot reached before it closed the hand.
        hand: joint positions of the hand at that moment (rad or m).
        measured: what the label is made of.
    """

    T_world_palm: Float[np.ndarray, "4 4"]
    hand: Float[np.ndarray, "h"]
    measured: Measurements


@dataclass(frozen=True)
class LiftStart:
    """Heights (m) of the object's centre of mass, at rest, and of the palm that is about to grasp it."""

    object_m: float
    palm_m: float


class Spectator(Protocol):
    """Someone who looks on: is shown the world after every control period."""

    def __call__(self, world: World, phase: str) -> None: ...


def _never() -> bool:
    return False


class GraspExecutor:
    """Executes one grasp in one world.

    The collision-free transit is not simulated: the robot starts at rest before the straight approach, in the
    preshape. From there on everything is physics.

    Args:
        world: a fresh world with a robot.
        physics, settings: time steps, control rate, closing.
        spectator: who looks on, if anyone.
    """

    def __init__(
        self,
        world: World,
        physics: PhysicsSettings,
        settings: ExecutionSettings,
        spectator: Spectator | None = None,
    ) -> None:
        if world.robot is None:
            raise ValueError("a grasp needs a world with a robot")
        self._world, self._robot = world, world.robot
        self._settings, self._spectator = settings, spectator
        self._steps = round(settings.control_period_s / physics.timestep_s)
        self._period_s = self._steps * physics.timestep_s
        self._highest_m = -np.inf

    def execute(
        self, motion: GraspMotion, preshape: Float[np.ndarray, "h"], grasp_type: GraspType
    ) -> Execution:
        """Execute a grasp with the hand in its preshape (joint positions, rad or m)."""
        resting_height_m = self._world.object_height_m
        self._show_transit(motion.transit, preshape)
        self._robot.place(motion.approach.positions[0], preshape)
        self._follow(motion.approach, "approach")
        self._wait(self._settings.settle_time_s, "approach")
        T_world_palm, hand = self._robot.palm_pose, self._robot.hand_positions
        self._close(preshape, grasp_type)
        self._highest_m = -np.inf
        start = LiftStart(resting_height_m, float(T_world_palm[2, 3]))
        is_lost = partial(self._is_lost, start)
        self._follow(motion.lift, "lift", is_lost)
        self._wait(self._settings.hold_time_s, "hold", is_lost)
        return Execution(T_world_palm, hand, self._measure(start))

    def _show_transit(self, transit: JointTrajectory, preshape: Float[np.ndarray, "h"]) -> None:
        """Without a spectator nothing happens: a pose that is not stepped leaves no trace in the physics."""
        if self._spectator is not None:
            positions, _ = transit.sample(np.arange(0.0, transit.duration_s, self._period_s))
            for arm in positions:
                self._robot.place(arm, preshape)
                self._spectator(self._world, "transit")

    def _follow(self, trajectory: JointTrajectory, phase: str, is_over: Callable[[], bool] = _never) -> None:
        times = np.arange(self._period_s, trajectory.duration_s + self._period_s, self._period_s)
        for positions, velocities in zip(*trajectory.sample(times), strict=True):
            self._robot.drive_arm(positions, velocities)
            self._advance(phase)
            if is_over():
                return

    def _wait(self, duration_s: float, phase: str, is_over: Callable[[], bool] = _never) -> None:
        for _ in range(round(duration_s / self._period_s)):
            self._advance(phase)
            if is_over():
                return

    def _is_lost(self, start: LiftStart) -> bool:
        """Whether nothing that may still happen changes the outcome; contacts, which cost most, come last."""
        limit, world = self._settings.lost_lag_m, self._world
        if limit is None:
            return False
        lag_m = self._robot.palm_height_m - start.palm_m - (world.object_height_m - start.object_m)
        return lag_m > limit and world.object_velocity[2] <= 0 and not world.object_touches_hand

    def _close(self, preshape: Float[np.ndarray, "h"], grasp_type: GraspType) -> None:
        robot = self._robot
        controller = ClosingController(
            robot.fingers, grasp_type, preshape, robot.robot.hand_upper_limits, self._settings.closing
        )
        while not controller.done:
            robot.drive_hand(controller.update(robot.hand_positions, self._period_s))
            self._advance("close")
        self._wait(self._settings.settle_time_s, "close")

    def _advance(self, phase: str) -> None:
        for _ in range(self._steps):
            self._world.step()
        self._highest_m = max(self._highest_m, self._world.object_height_m)
        if self._spectator is not None:
            self._spectator(self._world, phase)

    def _measure(self, start: LiftStart) -> Measurements:
        world = self._world
        return Measurements(
            final_height_m=world.object_height_m - start.object_m,
            highest_m=self._highest_m - start.object_m,
            palm_rise_m=self._robot.palm_height_m - start.palm_m,
            relative_speed_m_s=float(np.linalg.norm(world.object_velocity - self._robot.palm_velocity)),
            touches_hand=world.object_touches_hand,
            touches_support=world.object_touches_support,
        )
