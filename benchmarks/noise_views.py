"""Views of nothing in particular: what a network makes of them takes as long as of any other."""

import torch

from preshape.perception.object_view import CLOUD_SIZE, PATCH_SIZE
from preshape.perception.view_batch import ViewBatch


def noise_views(count: int, generator: torch.Generator) -> ViewBatch:
    """Patches of noise, and clouds of noise a metre before the camera."""
    box = torch.eye(4)
    box[2, 3] = 1.0
    return ViewBatch(
        patch=torch.rand(count, 8, PATCH_SIZE, PATCH_SIZE, generator=generator),
        intrinsics=torch.tensor([[525.0, 525.0, PATCH_SIZE / 2, PATCH_SIZE / 2]]).repeat(count, 1),
        points=0.05 * torch.randn(count, CLOUD_SIZE, 3, generator=generator) + box[:3, 3],
        table=torch.tensor([[0.0, 0.0, 1.0, 0.0]]).repeat(count, 1),
        T_camera_box=box.repeat(count, 1, 1),
    )
