"""Patches of an image that move and turn with a grasp, differentiable by bilinear interpolation."""

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn.functional import grid_sample


def cut_patches(
    image: Float[Tensor, "f c h w"],
    centres: Float[Tensor, "b n 2"],
    direction: Float[Tensor, "b 2"],
    size: int,
) -> Float[Tensor, "b n c size size"]:
    """Square patches around pixels, turned so that a direction of the image points up in them.

    Nothing is scaled or mirrored. What lies outside of the image is 0; within a pixel of its border the patch
    fades to that. The derivative by centre and direction is the exact one of the interpolated image; the
    paper takes finite differences (section 3.4, equation 5).

    Args:
        image: an image for each of the b grasps, or one that they share (f = 1).
        centres: pixel coordinates (u, v) of the patches' centres, which lie between the middle pixels where
            `size` is even.
        direction: unit vector in the image (u, v), for each grasp, that points up in its patches.
        size: width and height of the patches in pixels.
    """
    pixels = patch_pixels(centres, direction, size)
    # with align_corners, -1 and 1 are the centres of the first and the last pixel
    extent = pixels.new_tensor([image.shape[3] - 1, image.shape[2] - 1])
    grid = (2 * pixels / extent - 1).reshape(len(image), -1, size, 2)
    patches = grid_sample(image, grid, mode="bilinear", padding_mode="zeros", align_corners=True)
    batch, count = centres.shape[:2]
    apart = patches.reshape(len(image), image.shape[1], batch // len(image), count, size, size)
    return apart.permute(0, 2, 3, 1, 4, 5).reshape(batch, count, image.shape[1], size, size)


def patch_pixels(
    centres: Float[Tensor, "b n 2"], direction: Float[Tensor, "b 2"], size: int
) -> Float[Tensor, "b n size size 2"]:
    """Where in the image the pixels (u, v) of patches are, which `cut_patches` cuts."""
    down = -direction
    right = torch.stack((down[:, 1], -down[:, 0]), dim=1)
    steps = torch.arange(size, dtype=centres.dtype, device=centres.device) - (size - 1) / 2
    offsets = (
        steps[None, :, None, None] * down[:, None, None, :]
        + steps[None, None, :, None] * right[:, None, None, :]
    )
    return centres[:, :, None, None, :] + offsets[:, None]
