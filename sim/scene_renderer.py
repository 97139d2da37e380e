"""From a scene to what the camera sees of it."""

import hashlib
from dataclasses import asdict, dataclass
from functools import cached_property

import numpy as np
import sapien
from sapien.physx import PhysxCpuSystem

from preshape.data.scene import Scene
from preshape.perception.observation import Observation
from sim.camera import add_camera, colour, depth, segmentation, take_picture
from sim.kinect_noise import KinectNoise
from sim.objects.actor import add_object
from sim.objects.object_model import ObjectSet
from sim.robots.description import RobotDescription
from sim.scene_systems import make_render_system
from sim.simulated_robot import SimulatedRobot
from sim.table import TableSettings, build_table

RENDERING_VERSION = 1
"""To be raised with every change of the code that changes an image, so that caches notice."""
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
            RENDERING_VERSION,
            self.objects.fingerprint,
            asdict(self.table),
            None if self.noise is None else asdict(self.noise),
            None if self.robot is None else self.robot.urdf_path.read_text(),
            None if self.robot is None else (self.robot.arm_home.tolist(), self.robot.hand_open.tolist()),
        )
        return hashlib.sha256(repr(parts).encode()).hexdigest()

    def __call__(self, scene: Scene) -> Observation:
        """The RGB-D view of a scene.

        Raises:
            InputError: if the object is not in the set, or the machine cannot render.
        """
        stage, target = self._build(scene)
        lens = add_camera(stage, scene.camera)
        take_picture(stage, lens)
        measured = depth(lens)
        if self.noise is not None:
            measured = self.noise(measured, scene.camera, np.random.default_rng([scene.seed, NOISE_STREAM]))
        return Observation(colour(lens), measured, segmentation(lens) == target.per_scene_id, scene.camera)

    def _build(self, scene: Scene) -> tuple[sapien.Scene, sapien.Entity]:
        """A fresh stage, never stepped, and the object in it."""
        # Links of a robot find their places by physics only, bodies would merely cost time.
        if self.robot is None:
            stage = sapien.Scene([make_render_system()])
        else:
            stage = sapien.Scene([PhysxCpuSystem(), make_render_system()])
            SimulatedRobot(stage, self.robot).place(self.robot.arm_home, self.robot.hand_open)
        build_table(stage, self.table)
        return stage, add_object(stage, self.objects.load(scene.object_id), scene.T_world_object)
