"""The gripper's own frame is the one in which it is put at a rectangle, whichever way the camera looks."""

import numpy as np
import pytest
import torch

from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_views import RectangleViewSettings, rectangle_batch, rectangle_view
from preshape.geometry.camera import Camera
from preshape.grasps.rectangle_pose import RectanglePoseSettings, jaw_pose
from preshape.grasps.rectangle_space import theta_of
from preshape.hands.jaws import Jaws
from preshape.perception.grasp_patches import cut_patches
from preshape.perception.gripper_frame import UNIT_M, GripperFrame
from preshape.perception.hand_projection import RectangleProjection
from preshape.perception.observation import Observation

RECTANGLE = GraspRectangle(331.0, 228.0, 0.6, 36.0, 25.0)
MAX_TILT_RAD = 0.52
STEP_PX = 4


def ramp_seen_from(eye: list[float], slope: float) -> Observation:
    """A table at z = 0 with a ramp of a given slope on it, 0.05 m high in the middle."""
    camera = Camera.looking_at(np.array(eye), np.zeros(3), width=640, height=480, focal=525.0)
    x, y = np.broadcast_arrays(*camera.rays())
    rays = np.stack((x, y, np.ones_like(x)), axis=-1) @ camera.T_world_camera[:3, :3].T
    origin = camera.T_world_camera[:3, 3]
    table = -origin[2] / rays[..., 2]
    ramp = (0.05 + slope * origin[0] - origin[2]) / (rays[..., 2] - slope * rays[..., 0])
    on_ramp = np.abs(origin + ramp[..., None] * rays)[..., :2].max(axis=-1) < 0.12
    depth = np.where(on_ramp, ramp, table)
    return Observation(np.full((480, 640, 3), 128, np.uint8), depth.astype(np.float32), None, camera)


def framed(observation: Observation, rectangle: GraspRectangle) -> torch.Tensor:
    """Patches (7, 21, 21) around a rectangle's centre."""
    view = rectangle_batch([rectangle_view(observation, RectangleViewSettings(STEP_PX))])
    hand = RectangleProjection(Jaws(), STEP_PX)(
        torch.from_numpy(theta_of(rectangle)).float()[None], view.intrinsics
    )
    frame = GripperFrame(MAX_TILT_RAD)
    view = frame.without_holes(view)
    patches = cut_patches(view.patch, hand.palm[:, None], hand.direction, 21)
    return frame.surface(view, hand.palm[:, None], patches, hand)[0, 0]


@pytest.mark.parametrize("eye", [[-0.18, 0.0, 1.0], [0.3, 0.25, 0.9]])
@pytest.mark.parametrize("slope", [0.0, 0.3, 1.2])
def test_points_are_in_the_frame_of_the_pose_that_the_rectangle_means(eye: list[float], slope: float) -> None:
    observation = ramp_seen_from(eye, slope)
    camera = observation.camera
    up = camera.T_world_camera[2, :3]
    table = np.append(up, camera.T_world_camera[2, 3])
    pose = jaw_pose(RECTANGLE, observation, table, RectanglePoseSettings(max_tilt_rad=MAX_TILT_RAD))
    points = framed(observation, RECTANGLE)[4:] * UNIT_M
    c, s = np.cos(RECTANGLE.angle_rad), np.sin(RECTANGLE.angle_rad)
    aside, down = np.meshgrid(np.arange(-10, 11) * STEP_PX, np.arange(-10, 11) * STEP_PX)
    u = np.rint(RECTANGLE.u + aside * c - down * s).astype(int)
    v = np.rint(RECTANGLE.v + aside * s + down * c).astype(int)
    seen = camera.unproject(observation.depth)[v, u]
    approach, along, across = np.moveaxis((seen - pose.surface_point) @ pose.T_camera_jaws[:3, :3], -1, 0)
    # a gripper of two equal fingers is the same after half a turn about its approach
    half_turns = [np.stack((sign * along, -sign * across, -approach)) for sign in (-1, 1)]
    errors = [np.median(np.abs(own - points.numpy()), axis=(1, 2)) for own in half_turns]
    assert min(own.max() for own in errors) < 0.002


@pytest.mark.parametrize("step_px", [1, 4])
def test_heights_are_over_the_table_and_holes_are_on_it(step_px: int) -> None:
    observation = ramp_seen_from([-0.18, 0.0, 1.0], slope=0.0)
    observation.depth[100:140, 100:140] = np.nan
    view = GripperFrame(MAX_TILT_RAD).without_holes(
        rectangle_batch([rectangle_view(observation, RectangleViewSettings(step_px))])
    )
    z = view.patch[0, 3].double()
    columns, rows = torch.meshgrid(torch.arange(z.shape[1]), torch.arange(z.shape[0]), indexing="xy")
    fx, fy, cx, cy = view.intrinsics[0]
    points = torch.stack(((columns - cx) / fx * z, (rows - cy) / fy * z, z), dim=-1)
    height = points @ view.table[0, :3].double() + view.table[0, 3]
    assert height[120 // step_px, 120 // step_px].item() == pytest.approx(0.0, abs=1e-3)
    assert height[240 // step_px, 320 // step_px].item() == pytest.approx(0.05, abs=2e-3)
    assert height[-3, 3].item() == pytest.approx(0.0, abs=2e-3)
