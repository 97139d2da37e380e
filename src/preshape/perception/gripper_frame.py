"""The surface in an image as a two-finger gripper has it before it: in its own frame, not the camera's."""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import normalize

from preshape.perception.grasp_patches import cut_patches, patch_pixels
from preshape.perception.hand_projection import ProjectedHand
from preshape.perception.image import DEPTH, NORMALS
from preshape.perception.view_batch import ViewBatch

UNIT_M = 0.05
"""Unit of lengths for a network, about half of what a gripper opens."""
REACH_M = 0.15
"""Farther along an axis nothing matters to a grasp, and the floor beside a table is no deeper than this."""
FARTHEST_M = 10.0
"""Where a line of sight never meets the table, its point is put here."""
LEAST_NORMAL = 0.1
"""An interpolated normal is one if it is so long."""
LEAST_FACING = 0.1
"""A surface is taken as if the camera saw it no more at a glance than this cosine says."""


class GripperFrame(nn.Module):
    """Takes what surrounds a grasp into the frame of the gripper that executes it.

    A gripper aims at the surface point in a rectangle's middle and comes against the normal there
    (`preshape.grasps.rectangle_pose.jaw_pose`). What its fingers then meet depends on where the surface is
    along its approach, whichever way the camera looks. All is a differentiable function of the rectangle.

    Args:
        max_tilt_rad: largest angle between approach and vertical; normals that lean more are turned back.

    Attributes:
        channels: that a patch has of the surface: height, normal, point.
    """

    channels = 7

    def __init__(self, max_tilt_rad: float) -> None:
        super().__init__()
        self.max_tilt_rad = max_tilt_rad

    def without_holes(self, view: ViewBatch) -> ViewBatch:
        """Views whose pixels of unknown depth are on the table."""
        depth = view.patch[:, DEPTH]
        fx, fy, cx, cy = (part[:, None, None] for part in view.intrinsics.unbind(dim=1))
        rows, columns = (torch.arange(size).to(fx) for size in depth.shape[1:])
        a, b, c, d = (part[:, None, None] for part in view.table.unbind(dim=1))
        towards = a * ((columns[None, None, :] - cx) / fx) + b * ((rows[None, :, None] - cy) / fy) + c
        table = (-d / towards.clamp_max(-1e-6)).clamp(0.0, FARTHEST_M)
        patch = view.patch.clone()
        patch[:, DEPTH] = torch.where(depth > 0, depth, table)
        return view._replace(patch=patch)

    def surface(
        self,
        view: ViewBatch,
        centres: Float[Tensor, "b n 2"],
        patches: Float[Tensor, "b n 8 p p"],
        hand: ProjectedHand,
    ) -> Float[Tensor, "b n 7 p p"]:
        """Height over the table, normal and point of each pixel of patches.

        Normals and points are in the gripper's frame: along the opening, along the jaws, outwards; its origin
        is the surface point in the rectangle's middle. Lengths are in units of `UNIT_M`, as far as `REACH_M`.

        Args:
            view: of each grasp, or the one that all share, without holes.
            centres: pixels of the patches' centres.
            patches: cut from the view there.
            hand: where the grasps appear.
        """
        points = _points(patches[:, :, DEPTH], patch_pixels(centres, hand.direction, patches.shape[-1]), view)
        up, offset = view.table[:, None, :3, None, None], view.table[:, 3, None, None, None, None]
        height = (points * up).sum(dim=2, keepdim=True) + offset
        middle, axes = self._pose(view, hand)
        points = points - middle[:, None, :, None, None]
        normals, points = (
            torch.einsum("bij,bnjhw->bnihw", axes, own) for own in (patches[:, :, NORMALS], points)
        )
        height, points = (own.clamp(-REACH_M, REACH_M) / UNIT_M for own in (height, points))
        return torch.cat((height, normals, points), dim=2)

    def _pose(
        self, view: ViewBatch, hand: ProjectedHand
    ) -> tuple[Float[Tensor, "b 3"], Float[Tensor, "b 3 3"]]:
        """The surface point in the middle, and the gripper's axes as rows (camera frame)."""
        centre = hand.palm[:, None]
        pixel = cut_patches(view.patch, centre, hand.direction, 1)
        point = _points(pixel[:, :, DEPTH], centre[:, :, None, None], view)[:, 0, :, 0, 0]
        return point, self._axes(pixel[:, 0, NORMALS, 0, 0], point, view.table[:, :3], hand.direction)

    def _axes(
        self,
        normal: Float[Tensor, "b 3"],
        point: Float[Tensor, "b 3"],
        up: Float[Tensor, "#b 3"],
        direction: Float[Tensor, "b 2"],
    ) -> Float[Tensor, "b 3 3"]:
        """Where the surface has no normal, the gripper comes straight down."""
        known = normal.norm(dim=1, keepdim=True) > LEAST_NORMAL
        outwards = self._within_cone(normalize(torch.where(known, normal, up), dim=1), up)
        # the opening is across the approach, and appears level in the patch
        right = torch.stack((-direction[:, 1], direction[:, 0], torch.zeros_like(direction[:, 0])), dim=1)
        ray = point / point[:, 2:].clamp_min(1e-6)
        facing = (outwards * ray).sum(dim=1, keepdim=True).clamp_max(-LEAST_FACING)
        along = normalize(right - (outwards * right).sum(dim=1, keepdim=True) / facing * ray, dim=1)
        return torch.stack((along, torch.linalg.cross(outwards, along), outwards), dim=1)

    def _within_cone(self, normal: Float[Tensor, "b 3"], up: Float[Tensor, "#b 3"]) -> Float[Tensor, "b 3"]:
        """The unit vectors nearest to normals that lean no more than the gripper may."""
        most = normal.new_tensor(self.max_tilt_rad)
        cosine = (normal * up).sum(dim=1, keepdim=True)
        aside = normalize(normal - cosine * up, dim=1)
        return torch.where(cosine >= most.cos(), normal, most.cos() * up + most.sin() * aside)


def _points(
    depth: Float[Tensor, "b n h w"], pixels: Float[Tensor, "b n h w 2"], view: ViewBatch
) -> Float[Tensor, "b n 3 h w"]:
    """Points (m, camera frame) of a depth (m) in pixels (u, v) of views."""
    focal, centre = view.intrinsics[:, None, None, None, :2], view.intrinsics[:, None, None, None, 2:]
    u, v = ((pixels - centre) / focal).unbind(dim=-1)
    return torch.stack((u * depth, v * depth, depth), dim=2)
