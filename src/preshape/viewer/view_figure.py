"""What the camera sees, in the viewer's scene: coloured points, and the camera with its image."""

import math

import numpy as np
from viser import CameraFrustumHandle, PointCloudHandle, SceneApi

from preshape.geometry.pose import quaternion_from_pose, transform_points
from preshape.perception.observation import Observation

FRUSTUM_SCALE = 0.12
FRUSTUM_LINE_M = 0.004
IMAGE_STEP = 2
"""The frustum's image is made of every so many pixels."""


class ViewFigure:
    """An RGB-D view; another one takes its place.

    Args:
        scene: the viewer's scene.
    """

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self.cloud: PointCloudHandle | None = None
        self.camera: CameraFrustumHandle | None = None

    def show(self, observation: Observation) -> None:
        """Show a view."""
        camera = observation.camera
        points = camera.unproject(observation.depth.astype(np.float64))
        known = np.isfinite(observation.depth)
        was_visible = self.cloud is None or self.cloud.visible, self.camera is None or self.camera.visible
        self.cloud = self._scene.add_point_cloud(
            "/view/cloud",
            transform_points(camera.T_world_camera, points[known]).astype(np.float32),
            observation.rgb[known],
            # as large as its pixel, so that a surface looks like one
            point_size=float(np.median(observation.depth[known])) / camera.fx,
            precision="float32",
            point_shading="flat",
            visible=was_visible[0],
        )
        self.camera = self._scene.add_camera_frustum(
            "/view/camera",
            fov=2 * math.atan(camera.height / 2 / camera.fy),
            aspect=camera.width / camera.height,
            scale=FRUSTUM_SCALE,
            thickness=FRUSTUM_LINE_M,
            image=observation.rgb[::IMAGE_STEP, ::IMAGE_STEP],
            wxyz=quaternion_from_pose(camera.T_world_camera),
            position=camera.T_world_camera[:3, 3],
            visible=was_visible[1],
        )
