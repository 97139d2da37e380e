"""Making the cached view of a scene, against what SAPIEN alone needs for the picture."""

import logging
import multiprocessing
import os
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from comparison import Comparison
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.scene import Scene
from preshape.data.tables import SCENES_FILE, read_scenes
from preshape.data.view_cache import ViewCache
from preshape.paths import project_root
from sim.workers import ONE_THREAD

log = logging.getLogger("benchmarks")

WARM_UP_SCENES, SCENES = 2, 25
CORES = 2


def rendering(_seed: int, _flop_per_s: float) -> Comparison:
    """A view with all that it takes: picture, sensor noise, segmentation, eight channels, files.

    The bound is the time of the picture itself, drawn on the processor.
    """
    os.environ.update(ONE_THREAD)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as one_process:
        measured = one_process.submit(_render, SCENES).result()
    for what, seconds in (("with patches", measured.view_s), ("clouds alone", measured.cloud_s)):
        minutes = measured.scenes * seconds / CORES / 60
        log.info(
            "Rendering, %s: all %d scenes in %.1f minutes on %d cores", what, measured.scenes, minutes, CORES
        )
    log.info("Reading a patch from the cache: %.1f ms", 1e3 * measured.reading_s)
    return Comparison(
        "view of a scene, on one core",
        "SAPIEN's picture alone",
        measured.view_s,
        measured.picture_s,
        bound_s=measured.picture_s,
        runs=SCENES,
    )


class Rendering(NamedTuple):
    """Seconds for a view, without its patch, for its picture alone, and for reading a patch; all scenes."""

    view_s: float
    cloud_s: float
    picture_s: float
    reading_s: float
    scenes: int


def _render(count: int) -> Rendering:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("train")
    scenes = read_scenes(f"{cfg.dataset.data.folder}/{SCENES_FILE}").scenes
    renderer = instantiate(cfg.camera.renderer)
    some = scenes[:: -(-len(scenes) // (count + WARM_UP_SCENES))]
    with tempfile.TemporaryDirectory() as folder:
        views, clouds = ViewCache(f"{folder}/views", renderer), ViewCache(f"{folder}/clouds", renderer)
        view_s = _seconds(partial(views.make, with_patch=True), some)
        cloud_s = _seconds(partial(clouds.make, with_patch=False), some)
        reading_s = _seconds(views.patch, some)
    picture_s = _seconds(replace(renderer, noise=None), some)
    return Rendering(view_s, cloud_s, picture_s, reading_s, len(scenes))


def _seconds(work: Callable[[Scene], object], scenes: tuple[Scene, ...]) -> float:
    """Mean time for a scene, after the first ones."""
    for scene in scenes[:WARM_UP_SCENES]:
        work(scene)
    start = time.perf_counter()
    for scene in scenes[WARM_UP_SCENES:]:
        work(scene)
    return (time.perf_counter() - start) / len(scenes[WARM_UP_SCENES:])
