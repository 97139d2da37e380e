"""A `preshape` camera in a SAPIEN scene."""

from collections.abc import Sequence

import numpy as np
import sapien
from jaxtyping import Float32, Int, UInt8
from sapien.render import RenderCameraComponent

from preshape.geometry.camera import Camera
from sim.lean_shaders import lean_shaders
from sim.objects.actor import sapien_pose

NEAR_M, FAR_M = 0.05, 30.0

T_OPTICAL_SAPIEN = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
"""SAPIEN's camera looks along its x, with y to the left and z up, seen from the optical frame."""


def camera_looking_at(
    eye: Sequence[float], target: Sequence[float], width: int, height: int, focal: float
) -> Camera:
    """The camera of a configuration: at `eye`, looking at `target` (m, world); sizes in pixels."""
    return Camera.looking_at(
        np.array(eye, dtype=float),
        np.array(target, dtype=float),
        width=width,
        height=height,
        focal=float(focal),
    )


def add_camera(scene: sapien.Scene, camera: Camera) -> RenderCameraComponent:
    """Add a camera to a scene that can be looked at."""
    lens = RenderCameraComponent(camera.width, camera.height, lean_shaders())
    # SAPIEN counts from the image's corner, half a pixel before the first pixel's centre.
    lens.set_perspective_parameters(
        NEAR_M, FAR_M, camera.fx, camera.fy, camera.cx + 0.5, camera.cy + 0.5, 0.0
    )
    entity = sapien.Entity()
    entity.set_name("camera")
    entity.add_component(lens)
    place_camera(lens, camera)
    scene.add_entity(entity)
    return lens


def place_camera(lens: RenderCameraComponent, camera: Camera) -> None:
    """Put a camera that is in a scene where `camera` stands; their intrinsics must be the same."""
    lens.entity.set_pose(sapien_pose(camera.T_world_camera @ T_OPTICAL_SAPIEN))


def take_colour(scene: sapien.Scene, lens: RenderCameraComponent) -> UInt8[np.ndarray, "h w 3"]:
    """Colour image of the scene as it is now."""
    take_picture(scene, lens)
    return colour(lens)


def take_picture(scene: sapien.Scene, lens: RenderCameraComponent) -> None:
    """Expose the camera to the scene as it is now; the functions below read what it saw."""
    scene.update_render()
    lens.take_picture()


def colour(lens: RenderCameraComponent) -> UInt8[np.ndarray, "h w 3"]:
    """sRGB colour of the last picture."""
    levels = np.clip(lens.get_picture("Color")[..., :3], 0, 1)
    levels *= 255
    return np.rint(levels, out=levels).astype(np.uint8)


def depth(lens: RenderCameraComponent) -> Float32[np.ndarray, "h w"]:
    """Distance along the optical axis (m) of the last picture; NaN where there is nothing."""
    # "Position" is in the camera's OpenGL frame, which looks along its -z.
    distance = -lens.get_picture("Position")[..., 2]
    return np.where(distance > 0, distance, np.float32(np.nan))


def segmentation(lens: RenderCameraComponent) -> Int[np.ndarray, "h w"]:
    """Per-scene id of the entity behind each pixel of the last picture."""
    return lens.get_picture("Segmentation")[..., 1].astype(np.int64)
