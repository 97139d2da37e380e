"""The table, the floor below it and the light above it."""

from dataclasses import dataclass

import numpy as np
import sapien
from sapien.physx import (
    PhysxCollisionShapeBox,
    PhysxCollisionShapePlane,
    PhysxMaterial,
    PhysxRigidStaticComponent,
)
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeBox

from sim.scene_systems import has_physics, has_renderer

LEG_WIDTH_M = 0.05
FLOOR_HALF_SIZE_M = 10.0
FLOOR_THICKNESS_M = 0.02
# SAPIEN's planes face +x; this turns +x to the world's z.
PLANE_UP = (np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0)

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class TableSettings:
    """The table in the world frame (z up, origin on the floor under the robot's base column).

    Args:
        top_m: height of the table top over the floor.
        size_m: along x and y.
        centre_m: x and y of the middle of the table top.
        thickness_m: of the table top, which is what collides; the legs are for the eye.
        friction: Coulomb coefficient of table and floor.
        colour, leg_colour, floor_colour: linear RGB, 0-1.
        ambient: brightness of the light from everywhere.
        sun, fill: brightness of the lamp that casts the shadows and of the one opposite.
    """

    top_m: float = 0.59
    size_m: tuple[float, float] = (0.61, 0.9125)
    centre_m: tuple[float, float] = (0.8, 0.0)
    thickness_m: float = 0.04
    friction: float = 1.0
    colour: Colour = (0.36, 0.24, 0.14)
    leg_colour: Colour = (0.12, 0.12, 0.13)
    floor_colour: Colour = (0.22, 0.23, 0.24)
    ambient: float = 0.45
    sun: float = 1.6
    fill: float = 0.5


def build_table(scene: sapien.Scene, settings: TableSettings) -> tuple[sapien.Entity, sapien.Entity]:
    """Add table and floor to the scene, and lights where it can be looked at; returns table and floor.

    The origin of the table is the middle of its top.
    """
    table, floor = sapien.Entity(), sapien.Entity()
    table.set_name("table")
    floor.set_name("floor")
    if has_physics(scene):
        table.add_component(_table_body(settings))
        floor.add_component(_floor_body(settings))
    if has_renderer(scene):
        table.add_component(_table_visual(settings))
        floor.add_component(_floor_visual(settings))
        _add_lights(scene, settings)
    table.set_pose(sapien.Pose([*settings.centre_m, settings.top_m]))
    scene.add_entity(table)
    scene.add_entity(floor)
    return table, floor


def _table_body(settings: TableSettings) -> PhysxRigidStaticComponent:
    half_size = [settings.size_m[0] / 2, settings.size_m[1] / 2, settings.thickness_m / 2]
    slab = PhysxCollisionShapeBox(half_size, _material(settings))
    slab.set_local_pose(sapien.Pose([0, 0, -settings.thickness_m / 2]))
    body = PhysxRigidStaticComponent()
    body.attach(slab)
    return body


def _floor_body(settings: TableSettings) -> PhysxRigidStaticComponent:
    plane = PhysxCollisionShapePlane(_material(settings))
    plane.set_local_pose(sapien.Pose([0, 0, 0], PLANE_UP))
    body = PhysxRigidStaticComponent()
    body.attach(plane)
    return body


def _material(settings: TableSettings) -> PhysxMaterial:
    return PhysxMaterial(settings.friction, settings.friction, 0.0)


def _table_visual(settings: TableSettings) -> RenderBodyComponent:
    half_x, half_y = settings.size_m[0] / 2, settings.size_m[1] / 2
    body = RenderBodyComponent()
    half_top = settings.thickness_m / 2
    _attach_box(body, (0, 0, -half_top), (half_x, half_y, half_top), settings.colour)
    half_leg = LEG_WIDTH_M / 2
    half_length = (settings.top_m - settings.thickness_m) / 2
    for side_x in (-1, 1):
        for side_y in (-1, 1):
            centre = (
                side_x * (half_x - half_leg),
                side_y * (half_y - half_leg),
                -settings.thickness_m - half_length,
            )
            _attach_box(body, centre, (half_leg, half_leg, half_length), settings.leg_colour)
    return body


def _floor_visual(settings: TableSettings) -> RenderBodyComponent:
    half_size = (FLOOR_HALF_SIZE_M, FLOOR_HALF_SIZE_M, FLOOR_THICKNESS_M / 2)
    body = RenderBodyComponent()
    _attach_box(body, (0, 0, -FLOOR_THICKNESS_M / 2), half_size, settings.floor_colour)
    return body


def _attach_box(
    body: RenderBodyComponent,
    centre: tuple[float, float, float],
    half_size: tuple[float, float, float],
    colour: Colour,
) -> None:
    material = RenderMaterial(base_color=[*colour, 1.0], roughness=0.9, specular=0.1)
    box = RenderShapeBox(np.array(half_size, np.float32), material)
    box.set_local_pose(sapien.Pose(list(centre)))
    body.attach(box)


def _add_lights(scene: sapien.Scene, settings: TableSettings) -> None:
    scene.set_ambient_light([settings.ambient] * 3)
    scene.add_directional_light([0.4, 0.5, -1.0], [settings.sun] * 3, shadow=True)
    scene.add_directional_light([-0.3, 0.6, -0.4], [settings.fill] * 3)
