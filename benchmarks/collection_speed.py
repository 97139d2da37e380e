"""Collecting trials on one core, against what PhysX alone needs for the same steps."""

import logging
import multiprocessing
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager

from comparison import Comparison
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.trial import Trial
from preshape.paths import project_root
from sim.laboratory import Laboratory
from sim.scene_trials import try_grasps
from sim.workers import ONE_THREAD
from sim.world import World

log = logging.getLogger("benchmarks")

FIRST_SCENE = 1_000_000
"""Far behind the scenes of any data set."""
WARM_UP_SCENES, SCENES = 2, 25


def collection(seed: int, _flop_per_s: float) -> Comparison:
    """An executed trial with all that it takes: scene, image, segmentation, motion planning and physics.

    The bound is PhysX's own time for the steps that were simulated; nothing else is necessary in principle.
    """
    os.environ.update(ONE_THREAD)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as one_process:
        executed, wall_s, step_s = one_process.submit(_collect, seed, SCENES).result()
    ours_s, physics_s = wall_s / executed, step_s / executed
    hourly = (3600 / ours_s, 3600 / physics_s)
    log.info(
        "Collecting: %.0f executed trials an hour and core; %.0f if nothing but PhysX took time", *hourly
    )
    return Comparison(
        "executed trial of a collection, on one core",
        "PhysX alone, for the same steps",
        ours_s,
        physics_s,
        bound_s=physics_s,
        runs=executed,
    )


def _collect(seed: int, scenes: int) -> tuple[int, float, float]:
    """Executed trials, the seconds that they took, and those in which PhysX made steps."""
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        laboratory = instantiate(compose("collect").laboratory)
    for scene_id in range(FIRST_SCENE, FIRST_SCENE + WARM_UP_SCENES):
        _trials(laboratory, seed, scene_id)
    first = FIRST_SCENE + WARM_UP_SCENES
    with _timed_steps() as step_s:
        start = time.perf_counter()
        trials = [trial for k in range(first, first + scenes) for trial in _trials(laboratory, seed, k)]
        wall_s = time.perf_counter() - start
    return sum(trial.outcome.executed for trial in trials), wall_s, sum(step_s)


def _trials(laboratory: Laboratory, seed: int, scene_id: int) -> list[Trial]:
    scene = laboratory.scenes.make(seed, scene_id)
    return [] if scene is None else try_grasps(laboratory, seed, scene)


@contextmanager
def _timed_steps() -> Iterator[list[float]]:
    """Seconds of every physics step made in the body."""
    seconds: list[float] = []
    step = World.step

    def timed_step(world: World) -> None:
        start = time.perf_counter()
        step(world)
        seconds.append(time.perf_counter() - start)

    World.step = timed_step
    try:
        yield seconds
    finally:
        World.step = step
