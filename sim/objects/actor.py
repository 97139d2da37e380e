"""Putting an object into a SAPIEN scene."""

from dataclasses import dataclass

import numpy as np
import sapien
from jaxtyping import Float
from sapien.physx import PhysxCollisionShapeConvexMesh, PhysxMaterial, PhysxRigidDynamicComponent
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from preshape.geometry.pose import quaternion_from_pose
from sim.objects.object_model import ObjectModel, VisualPart

ROUGHNESS = 0.6
SPECULAR = 0.3


@dataclass(frozen=True)
class ContactSettings:
    """How PhysX treats the object.

    Args:
        restitution: 0 does not bounce.
        solver_position_iterations, solver_velocity_iterations: per step; grasps by several fingers want 20 or more.
        contact_offset_m: distance at which PhysX begins to make contacts.
    """

    restitution: float = 0.0
    solver_position_iterations: int = 25
    solver_velocity_iterations: int = 1
    contact_offset_m: float = 0.002


def add_object(
    scene: sapien.Scene,
    model: ObjectModel,
    T_world_object: Float[np.ndarray, "4 4"],
    contact: ContactSettings | None = None,
    *,
    visible: bool = True,
) -> sapien.Entity:
    """Add the object to the scene at a pose.

    `contact` None makes it an image only, without physics. `visible` False leaves out what the camera sees.
    """
    entity = sapien.Entity()
    entity.set_name(model.object_id)
    if contact is not None:
        entity.add_component(rigid_body(model, contact))
    if visible:
        entity.add_component(render_body(model))
    entity.set_pose(sapien_pose(T_world_object))
    scene.add_entity(entity)
    return entity


def rigid_body(model: ObjectModel, contact: ContactSettings) -> PhysxRigidDynamicComponent:
    """The object's body; PhysX takes mass and inertia from the parts at the model's density."""
    material = PhysxMaterial(model.friction, model.friction, contact.restitution)
    body = PhysxRigidDynamicComponent()
    for vertices in model.collision_parts:
        shape = PhysxCollisionShapeConvexMesh(vertices.astype(np.float32), np.ones(3, np.float32), material)
        shape.set_density(model.density)
        shape.set_contact_offset(contact.contact_offset_m)
        body.attach(shape)
    body.set_solver_position_iterations(contact.solver_position_iterations)
    body.set_solver_velocity_iterations(contact.solver_velocity_iterations)
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
        pixels = np.ascontiguousarray(np.concatenate((part.texture, opaque), axis=2))
        material.set_base_color_texture(RenderTexture2D(pixels, "R8G8B8A8Unorm", srgb=True))
    return RenderShapeTriangleMesh(part.vertices, part.faces, part.normals, uvs, material)
