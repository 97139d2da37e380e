"""From a scene to what the camera sees of it."""

import hashlib
from dataclasses import asdict, dataclass
from functools import cached_property

import numpy as np
import sapien
from sapien.physx import PhysxCpuSystem
from sapien.render import RenderCameraComponent

from preshape.data.scene import Scene
from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation
from preshape.source_digest import source_digest
from sim.camera import add_camera, colour, depth, place_camera, segmentation, take_picture
from sim.kinect_noise import KinectNoise
from sim.objects.actor import add_object
from sim.objects.object_model import ObjectSet
from sim.robots.appearance import appearance_digest
from sim.robots.description import RobotDescription
from sim.scene_systems import make_render_system
from sim.simulated_robot import SimulatedRobot
from sim.table import TableSettings, build_table

NOISE_STREAM = 2
"""Keeps the sensor's random numbers apart from others that start from the scene's seed."""


@dataclass(frozen=True, eq=False)
class SapienSceneRenderer:
    """Renders scenes in SAPIEN: a `preshape.data.scene.SceneRenderer`, a pure function of the scene.

    Args:
        objects: the set that the scenes' objects are from.
        table: the table that they stand on.
        noise: what the sensor adds to the depth; None gives the true depth.
        robot: stands at rest in the picture, as in the paper; None leaves it out.
    """

    objects: ObjectSet
    table: TableSettings
    noise: KinectNoise | None = None
    robot: RobotDescription | None = None

    @cached_property
    def fingerprint(self) -> str:
        """Hash of all that an image depends on besides its scene."""
        parts = (
            source_digest(__name__),
            sapien.__version__,
            self.objects.fingerprint,
            asdict(self.table),
            None if self.noise is None else asdict(self.noise),
            None if self.robot is None else appearance_digest(self.robot),
        )
        return hashlib.sha256(repr(parts).encode()).hexdigest()

    def __reduce__(self) -> tuple[object, ...]:
        """Other processes get what the renderer is made of, not its stage."""
        return type(self), (self.objects, self.table, self.noise, self.robot)

    def __call__(self, scene: Scene) -> Observation:
        """The RGB-D view of a scene.

        Raises:
            InputError: if the object is not in the set, or the machine cannot render.
        """
        model = self.objects.load(scene.object_id)
        lens = self._lens(scene.camera)
        target = add_object(self._stage, model, scene.T_world_object)
        try:
            take_picture(self._stage, lens)
            rgb, measured, mask = colour(lens), depth(lens), segmentation(lens) == target.per_scene_id
        finally:
            self._stage.remove_entity(target)
        if self.noise is not None:
            measured = self.noise(measured, scene.camera, np.random.default_rng([scene.seed, NOISE_STREAM]))
        return Observation(rgb, measured, mask, scene.camera)

    @cached_property
    def _stage(self) -> sapien.Scene:
        """What all scenes share, never stepped. It stays, because building it costs more than an object."""
        # Links of a robot find their places by physics only, bodies would merely cost time.
        if self.robot is None:
            stage = sapien.Scene([make_render_system()])
        else:
            stage = sapien.Scene([PhysxCpuSystem(), make_render_system()])
            SimulatedRobot(stage, self.robot).place(self.robot.arm_home, self.robot.hand_open)
        build_table(stage, self.table)
        return stage

    @cached_property
    def _lenses(self) -> dict[tuple[float, ...], RenderCameraComponent]:
        """Cameras of the stage by their intrinsics."""
        return {}

    def _lens(self, camera: Camera) -> RenderCameraComponent:
        intrinsics = (camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy)
        lens = self._lenses.get(intrinsics)
        if lens is None:
            lens = self._lenses[intrinsics] = add_camera(self._stage, camera)
        place_camera(lens, camera)
        return lens
