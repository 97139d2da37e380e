"""Putting an object into a SAPIEN scene."""

import numpy as np
import sapien
from jaxtyping import Float
from sapien.physx import PhysxCollisionShapeConvexMesh, PhysxMaterial, PhysxRigidDynamicComponent
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from preshape.geometry.pose import quaternion_from_pose
from sim.objects.object_model import ObjectModel, VisualPart
from sim.scene_systems import has_physics, has_renderer

ROUGHNESS = 0.6
SPECULAR = 0.3
COOKING_SCALE = 10.0
"""PhysX drops vertices within 0.7 mm of a plane when it cooks a hull; cooked larger, it keeps the shape."""


def add_object(
    scene: sapien.Scene, model: ObjectModel, T_world_object: Float[np.ndarray, "4 4"]
) -> sapien.Entity:
    """Add the object to the scene at a pose.

    It gets a body if the scene has physics, under PhysX's current body and shape settings, and is drawn if
    the scene can be looked at.
    """
    entity = sapien.Entity()
    entity.set_name(model.object_id)
    if has_physics(scene):
        entity.add_component(rigid_body(model))
    if has_renderer(scene):
        entity.add_component(render_body(model))
    entity.set_pose(sapien_pose(T_world_object))
    scene.add_entity(entity)
    return entity


def rigid_body(model: ObjectModel) -> PhysxRigidDynamicComponent:
    """The object's body; PhysX takes mass and inertia from the parts at the model's density."""
    material = PhysxMaterial(model.friction, model.friction, 0.0)
    body = PhysxRigidDynamicComponent()
    for vertices in model.collision_parts:
        shape = PhysxCollisionShapeConvexMesh(
            (vertices * COOKING_SCALE).astype(np.float32), np.full(3, 1 / COOKING_SCALE, np.float32), material
        )
        shape.set_density(model.density)
        body.attach(shape)
    return body


def render_body(model: ObjectModel) -> RenderBodyComponent:
    """What the camera sees of the object."""
    body = RenderBodyComponent()
    for part in model.visual_parts:
        body.attach(_render_shape(part))
    return body


def sapien_pose(pose: Float[np.ndarray, "4 4"]) -> sapien.Pose:
    """A 4x4 pose as SAPIEN's own type."""
    return sapien.Pose(pose[:3, 3], quaternion_from_pose(pose))


def _render_shape(part: VisualPart) -> RenderShapeTriangleMesh:
    material = RenderMaterial(base_color=[*part.colour, 1.0], roughness=ROUGHNESS, specular=SPECULAR)
    uvs = np.zeros((len(part.vertices), 2), np.float32) if part.uvs is None else part.uvs
    if part.texture is not None:
        opaque = np.full((*part.texture.shape[:2], 1), 255, np.uint8)
        # The first row of an array is where v is 0 for SAPIEN.
        pixels = np.ascontiguousarray(np.flipud(np.concatenate((part.texture, opaque), axis=2)))
        material.set_base_color_texture(RenderTexture2D(pixels, "R8G8B8A8Unorm", srgb=True))
    return RenderShapeTriangleMesh(part.vertices, part.faces, part.normals, uvs, material)
