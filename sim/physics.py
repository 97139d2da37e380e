"""The physics engine's settings, and empty scenes that obey them."""

from dataclasses import dataclass

import sapien
from sapien import physx

from sim.scene_systems import make_render_system


@dataclass(frozen=True)
class PhysicsSettings:
    """Settings of PhysX.

    Args:
        timestep_s: length of one physics step.
        solver_iterations: position iterations; multi-finger grasps need 20 or more.
        contact_offset_m: distance at which contacts are made.
        friction: static and dynamic friction of the hand; table and objects have their own.
    """

    timestep_s: float = 1 / 240
    solver_iterations: int = 25
    contact_offset_m: float = 0.004
    friction: float = 1.0


def make_scene(settings: PhysicsSettings, *, rendered: bool) -> sapien.Scene:
    """Empty scene; a fresh one per trial, because a reused scene drifts by centimetres.

    Args:
        settings: what PhysX is to use.
        rendered: whether the scene can be looked at; physics alone is cheaper.
    """
    physx.set_scene_config(bounce_threshold=0.2, enable_pcm=True, enable_tgs=True)
    physx.set_body_config(solver_position_iterations=settings.solver_iterations)
    physx.set_shape_config(contact_offset=settings.contact_offset_m)
    physx.set_default_material(settings.friction, settings.friction, 0.0)
    systems: list[sapien.System] = [physx.PhysxCpuSystem()]
    if rendered:
        systems.append(make_render_system())
    scene = sapien.Scene(systems)
    scene.set_timestep(settings.timestep_s)
    return scene
