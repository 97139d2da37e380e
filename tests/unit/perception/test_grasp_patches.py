"""Patches are cut where the hand appears, turned with it, and differentiable."""

from typing import Any

import numpy as np
import torch
from torch import Tensor

from preshape.geometry.pose import invert_pose, make_pose
from preshape.grasps.space import GraspSpace
from preshape.hands.allegro import allegro_hand
from preshape.perception.grasp_patches import cut_patches
from preshape.perception.hand_projection import HandProjection, ProjectedHand, project

HAND = HandProjection(allegro_hand())
SPACE = GraspSpace.palm_and_joints("test", {f"joint_{k}": (-1.0, 1.0) for k in range(8)})


def side_grasp(T_world_camera: np.ndarray) -> np.ndarray:
    """Palm before the table's centre, looking along the world's +y, thumb up, the fingers spread a little."""
    rotation = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    palm = make_pose(rotation, np.array([0.8, -0.1, 0.75]))
    return SPACE.theta(invert_pose(T_world_camera) @ palm, np.linspace(-0.2, 0.6, 8))


def project_side_grasp(camera: Any) -> tuple[Tensor, Tensor, ProjectedHand]:
    theta = torch.tensor(side_grasp(camera.T_world_camera))[None]
    intrinsics = torch.tensor([[camera.fx, camera.fy, camera.cx, camera.cy]], dtype=torch.float64)
    return theta, intrinsics, HAND(theta, intrinsics)


def coordinates(height: int, width: int) -> Tensor:
    """An image whose two channels are the pixel coordinates u and v."""
    v, u = torch.meshgrid(
        torch.arange(height, dtype=torch.float64), torch.arange(width, dtype=torch.float64), indexing="ij"
    )
    return torch.stack((u, v))[None]


def test_hand_projects_as_the_camera_projects_its_points(table_top: Any) -> None:
    camera = table_top.camera
    theta, _, seen = project_side_grasp(camera)
    points = torch.cat((theta[:, None, :3], HAND.hand.fingertips(theta)), dim=1)
    expected = torch.stack(camera.project(points), dim=-1)
    torch.testing.assert_close(torch.cat((seen.palm[:, None], seen.fingertips), dim=1), expected)


def test_direction_is_the_way_that_a_point_on_the_finger_axis_moves(table_top: Any) -> None:
    theta, intrinsics, seen = project_side_grasp(table_top.camera)
    axis = HAND.hand.palm_link_pose(theta)[:, :3, 2]
    ahead, behind = (project(theta[:, None, :3] + step * axis, intrinsics)[:, 0] for step in (1e-6, -1e-6))
    expected = torch.nn.functional.normalize(ahead - behind, dim=1)
    torch.testing.assert_close(seen.direction, expected, atol=1e-6, rtol=0)


def test_a_hand_that_points_at_the_camera_or_is_behind_it_still_projects_somewhere() -> None:
    intrinsics = torch.tensor([[500.0, 500.0, 200.0, 200.0]], dtype=torch.float64)
    for depth in (0.0, -1.0, 1.0):
        theta = torch.zeros((1, 14), dtype=torch.float64)
        theta[0, 2] = depth
        theta.requires_grad_()
        seen = HAND(theta, intrinsics)
        assert all(part.isfinite().all() for part in seen)
        (gradient,) = torch.autograd.grad(sum(part.sum() for part in seen), theta)
        assert gradient.isfinite().all()


def test_an_upright_patch_at_a_whole_pixel_is_a_crop() -> None:
    image = torch.rand(1, 3, 20, 30, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    up = torch.tensor([[0.0, -1.0]], dtype=torch.float64)
    odd = cut_patches(image, torch.tensor([[[12.0, 9.0]]], dtype=torch.float64), up, 7)
    torch.testing.assert_close(odd[0, 0], image[0, :, 6:13, 9:16])
    even = cut_patches(image, torch.tensor([[[12.5, 9.5]]], dtype=torch.float64), up, 8)
    torch.testing.assert_close(even[0, 0], image[0, :, 6:14, 9:17])


def test_a_turned_patch_shows_the_direction_upwards_and_nothing_mirrored() -> None:
    angle = torch.tensor([0.4, 2.0], dtype=torch.float64)
    direction = torch.stack((angle.cos(), angle.sin()), dim=1)
    centres = torch.tensor([[[20.0, 22.0]], [[25.3, 18.6]]], dtype=torch.float64)
    patches = cut_patches(coordinates(50, 50), centres, direction, 9)[:, 0]
    torch.testing.assert_close(patches[:, :, 4, 4], centres[:, 0])
    torch.testing.assert_close(patches[:, :, 3, 4] - patches[:, :, 4, 4], direction)
    turned_right = torch.stack((-direction[:, 1], direction[:, 0]), dim=1)
    torch.testing.assert_close(patches[:, :, 4, 5] - patches[:, :, 4, 4], turned_right)


def test_outside_of_the_image_is_zero() -> None:
    up = torch.tensor([[0.0, -1.0]])
    patch = cut_patches(torch.ones(1, 1, 10, 10), torch.tensor([[[0.0, 0.0]]]), up, 7)[0, 0, 0]
    expected = torch.zeros(7, 7)
    expected[3:, 3:] = 1.0
    torch.testing.assert_close(patch, expected, atol=1e-5, rtol=0)


def test_grasps_may_share_an_image() -> None:
    generator = torch.Generator().manual_seed(1)
    image = torch.rand(1, 8, 40, 40, generator=generator)
    centres = 40 * torch.rand(3, 5, 2, generator=generator)
    direction = torch.nn.functional.normalize(torch.randn(3, 2, generator=generator), dim=1)
    shared = cut_patches(image, centres, direction, 12)
    assert shared.shape == (3, 5, 8, 12, 12)
    torch.testing.assert_close(shared, cut_patches(image.repeat(3, 1, 1, 1), centres, direction, 12))


def test_gradient_from_patches_to_theta_agrees_with_finite_differences(table_top: Any) -> None:
    theta, intrinsics, _ = project_side_grasp(table_top.camera)
    image = torch.rand(1, 2, 48, 64, generator=torch.Generator().manual_seed(2), dtype=torch.float64)
    small = intrinsics / 10  # the same view with a tenth of the pixels

    def patches(theta: Tensor) -> Tensor:
        seen = HAND(theta, small)
        return cut_patches(image, torch.cat((seen.palm[:, None], seen.fingertips), 1), seen.direction, 4)

    assert torch.autograd.gradcheck(patches, theta.requires_grad_(), eps=1e-8, atol=1e-5)


def test_what_is_drawn_at_a_fingertip_is_in_the_middle_of_its_patch(table_top: Any) -> None:
    camera = table_top.camera
    theta, _, seen = project_side_grasp(camera)
    tips = HAND.hand.fingertips(theta)[0].numpy()
    image = np.zeros((1, len(tips), camera.height, camera.width))
    for finger, (u, v) in enumerate(np.stack(camera.project(tips), axis=-1)):
        rows, columns = (slice(round(x) - 2, round(x) + 3) for x in (v, u))
        image[0, finger, rows, columns] = 1.0
    patches = cut_patches(torch.from_numpy(image), seen.fingertips, seen.direction, 41)[0]
    for finger in range(len(tips)):
        own = patches[finger, finger]
        assert own[19:22, 19:22].min() > 0.99
        assert own[:16].max() == 0
