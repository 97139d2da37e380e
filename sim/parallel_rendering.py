"""Rendering the views of many scenes in worker processes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from preshape.data.scene import Scene
from preshape.data.view_cache import ViewCache, one_by_one
from preshape.errors import InputError
from sim.workers import BeginStep, Work, Workers, available_cores

SCENES_PER_WORKER = 30
"""Fewer are not worth another process, which needs some seconds to start."""


@dataclass(frozen=True)
class ParallelRendering:
    """A `preshape.data.view_cache.ViewMaker`: one thread and one renderer in each of several processes.

    Args:
        workers: number of processes; None takes every core.
        scene_limit_s: a worker that needs longer for a scene is taken for stuck, and replaced (s).
    """

    workers: int | None = None
    scene_limit_s: float = 120.0

    def __call__(self, cache: ViewCache, scenes: Sequence[Scene], *, with_patches: bool) -> Iterator[Scene]:
        """Make the views; yields each scene when its view is there.

        Raises:
            InputError: if a view cannot be made, or its worker dies again and again.
        """
        count = min(self.workers or available_cores(), -(-len(scenes) // SCENES_PER_WORKER))
        if count <= 1:
            yield from one_by_one(cache, scenes, with_patches=with_patches)
            return
        waiting = list(range(len(scenes)))
        with Workers(
            partial(_renderer, cache, tuple(scenes), with_patches), count, self.scene_limit_s
        ) as workers:
            while waiting or workers.busy:
                while waiting and workers.free:
                    workers.give(waiting.pop())
                for number, made in workers.wait(1.0):
                    if not made:
                        raise InputError(
                            f"The view of scene {scenes[number].scene_id} cannot be made: its worker fails",
                            where=cache.path(scenes[number], "cloud"),
                            fix="look at the warnings above; if memory is short, take fewer workers",
                        )
                    yield scenes[number]


def _renderer(cache: ViewCache, scenes: Sequence[Scene], with_patches: bool) -> Work[int, bool]:
    return partial(_render, cache, scenes, with_patches)


def _render(
    cache: ViewCache, scenes: Sequence[Scene], with_patches: bool, number: int, begin: BeginStep
) -> bool:
    if not begin("rendering"):
        return False
    cache.make(scenes[number], with_patch=with_patches)
    return True
