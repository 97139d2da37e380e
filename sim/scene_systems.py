"""Which parts of SAPIEN a scene has: physics, pictures or both."""

import logging
from functools import cache

import sapien
from sapien.render import RenderSystem

from preshape.errors import InputError

logging.getLogger("sapien").setLevel(logging.ERROR)
sapien.set_log_level("error")
sapien.render.set_log_level("error")


def has_physics(scene: sapien.Scene) -> bool:
    """Whether bodies can move and touch in the scene."""
    return _has_system(scene, "physx")


def has_renderer(scene: sapien.Scene) -> bool:
    """Whether the scene can be looked at."""
    return _has_system(scene, "render")


def make_render_system() -> RenderSystem:
    """What makes a scene visible; every scene needs its own.

    The first one of a process compiles the shaders, at its first picture, which takes some 2 s on a CPU.

    Raises:
        InputError: if the machine has no Vulkan device that SAPIEN can use.
    """
    try:
        _hold_device()
        return RenderSystem()
    except RuntimeError as error:
        raise InputError(
            f"SAPIEN found no usable Vulkan device ({error})",
            where="the graphics driver",
            fix="run `make setup`, which installs Mesa's software renderer (lavapipe, Mesa 24.3 or newer)",
        ) from error


@cache
def _hold_device() -> RenderSystem:
    """Keeps the Vulkan device and its shaders: without a living render system they go with the last scene."""
    return RenderSystem()


def _has_system(scene: sapien.Scene, name: str) -> bool:
    try:
        scene.get_system(name)
    except RuntimeError:
        return False
    return True
