"""Making the cached patch of a scene, against what SAPIEN alone needs for the picture."""

import logging
import multiprocessing
import os
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

from comparison import Comparison
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.entry_point  # noqa: F401  (registers the configuration's resolvers)
from preshape.data.scene import Scene
from preshape.data.tables import SCENES_FILE, read_scenes
from preshape.data.view_cache import ViewCache
from preshape.paths import project_root
from sim.workers import ONE_THREAD

log = logging.getLogger("benchmarks")

WARM_UP_SCENES, SCENES = 2, 25
CORES = 2


def rendering(_seed: int, _flop_per_s: float) -> Comparison:
    """A patch with all that it takes: picture, sensor noise, segmentation, eight channels, file.

    The bound is the time of the picture itself, drawn on the processor.
    """
    os.environ.update(ONE_THREAD)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as one_process:
        patch_s, picture_s, reading_s, n_scenes = one_process.submit(_render, SCENES).result()
    minutes = n_scenes * patch_s / CORES / 60
    log.info("Rendering: all %d scenes in %.1f minutes on %d cores", n_scenes, minutes, CORES)
    log.info("Reading a patch from the cache: %.1f ms", 1e3 * reading_s)
    return Comparison(
        "patch of a scene, on one core",
        "SAPIEN's picture alone",
        patch_s,
        picture_s,
        bound_s=picture_s,
        runs=SCENES,
    )


def _render(count: int) -> tuple[float, float, float, int]:
    """Seconds for a patch, for its picture alone, and for reading it; and the number of shipped scenes."""
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("train")
    scenes = read_scenes(f"{cfg.dataset.data.folder}/{SCENES_FILE}").scenes
    renderer = instantiate(cfg.camera.renderer)
    some = scenes[:: -(-len(scenes) // (count + WARM_UP_SCENES))]
    with tempfile.TemporaryDirectory() as folder:
        cache = ViewCache(folder, renderer)
        patch_s = _seconds(cache.make, some)
        reading_s = _seconds(cache.__getitem__, some)
    return patch_s, _seconds(replace(renderer, noise=None), some), reading_s, len(scenes)


def _seconds(work: Callable[[Scene], object], scenes: tuple[Scene, ...]) -> float:
    """Mean time for a scene, after the first ones."""
    for scene in scenes[:WARM_UP_SCENES]:
        work(scene)
    start = time.perf_counter()
    for scene in scenes[WARM_UP_SCENES:]:
        work(scene)
    return (time.perf_counter() - start) / len(scenes[WARM_UP_SCENES:])
