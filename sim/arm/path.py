"""Free paths of the arm, by OMPL's RRT-Connect."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from ompl import base, geometric, util

util.setLogLevel(util.LogLevel.LOG_NONE)


@dataclass(frozen=True)
class PathSettings:
    """How free paths are searched for.

    The search is bounded by iterations, not by time, so that the same seed gives the same path.

    Args:
        iterations: growth steps of the two trees before an attempt gives up.
        range_rad: longest step by which a tree grows.
        resolution_rad: distance of the configurations checked along a step.
        shortcuts: attempts to cut a corner of the path found.
    """

    iterations: int = 1500
    range_rad: float = 0.8
    resolution_rad: float = 0.05
    shortcuts: int = 60


def find_path(
    start: Float[np.ndarray, "a"],
    goal: Float[np.ndarray, "a"],
    is_free: Callable[[Float[np.ndarray, "a"]], bool],
    joint_limits: tuple[Float[np.ndarray, "a"], Float[np.ndarray, "a"]],
    settings: PathSettings,
    seed: int,
) -> Float[np.ndarray, "n a"] | None:
    """A shortened free path between two free configurations.

    Args:
        start, goal: joint angles (rad).
        is_free: whether the arm may be at some joint angles.
        joint_limits: lower and upper (rad).
        settings: how to search.
        seed: seed of OMPL's generators, from 1. They are global: queries of one process must not overlap.

    Returns:
        The corners of the path, or None if none was found.
    """
    util.RNG.setSeed(seed)
    space = _joint_space(*joint_limits)
    information = base.SpaceInformation(space)
    dim = len(start)
    information.setStateValidityChecker(lambda state: is_free(np.array([state[k] for k in range(dim)])))
    information.setStateValidityCheckingResolution(settings.resolution_rad / space.getMaximumExtent())
    information.setup()
    problem = base.ProblemDefinition(information)
    problem.setStartAndGoalStates(_state(space, start), _state(space, goal))
    planner = geometric.RRTConnect(information)
    planner.setRange(settings.range_rad)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.PlannerTerminationCondition(_Countdown(settings.iterations)))
    if not problem.hasExactSolution():
        return None
    path = problem.getSolutionPath()
    simplifier = geometric.PathSimplifier(information)
    simplifier.reduceVertices(path, settings.shortcuts, settings.shortcuts)
    simplifier.partialShortcutPath(path, settings.shortcuts, settings.shortcuts)
    simplifier.smoothBSpline(path, 3)
    return np.array([[state[k] for k in range(dim)] for state in path.getStates()])


class _Countdown:
    """Tells a planner to stop after so many questions."""

    def __init__(self, questions: int) -> None:
        self._left = questions

    def __call__(self) -> bool:
        self._left -= 1
        return self._left < 0


def _joint_space(lower: Float[np.ndarray, "a"], upper: Float[np.ndarray, "a"]) -> base.RealVectorStateSpace:
    space = base.RealVectorStateSpace(len(lower))
    bounds = base.RealVectorBounds(len(lower))
    for k, (low, high) in enumerate(zip(lower, upper, strict=True)):
        bounds.setLow(k, float(low))
        bounds.setHigh(k, float(high))
    space.setBounds(bounds)
    return space


def _state(space: base.RealVectorStateSpace, positions: Float[np.ndarray, "a"]) -> base.State:
    state = space.allocState()
    for k, angle in enumerate(positions):
        state[k] = float(angle)
    return state
