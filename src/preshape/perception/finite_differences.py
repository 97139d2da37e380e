"""Derivatives of image patches by finite differences (paper, section 3.4, equation 5)."""

from collections.abc import Callable, Sequence
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

Cut = Callable[[Tensor], tuple[Tensor, ...]]
"""Patches of b grasps, several tensors (b, ...), as a function of theta (b, d)."""


def with_finite_differences(cut: Cut, theta: Float[Tensor, "b d"], steps: Sequence[float]) -> Any:
    """The patches of grasps, whose derivative by theta is that of central differences.

    dp/dtheta_k = (p(theta + e_k) - p(theta - e_k)) / (2 |e_k|): 2 d further cuts for a gradient, none
    without one.

    Args:
        cut: cuts the patches, each grasp's by itself.
        theta: the grasps.
        steps: |e_k| for each of the d parameters, in their units.
    """
    return _FiniteDifferences.apply(theta, cut, steps)  # type: ignore[no-untyped-call]


class _FiniteDifferences(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, theta: Tensor, cut: Cut, steps: Sequence[float]) -> tuple[Tensor, ...]:
        ctx.theta, ctx.cut, ctx.steps = theta.detach(), cut, steps
        return cut(ctx.theta)

    @staticmethod
    def backward(ctx: Any, *outer: Tensor) -> tuple[Tensor, None, None]:
        gradient = torch.zeros_like(ctx.theta)
        for k, step in enumerate(ctx.steps):
            ahead, behind = ctx.theta.clone(), ctx.theta.clone()
            ahead[:, k] += step
            behind[:, k] -= step
            for weight, after, before in zip(outer, ctx.cut(ahead), ctx.cut(behind), strict=True):
                gradient[:, k] += (weight * (after - before)).flatten(1).sum(dim=1) / (2 * step)
        return gradient, None, None
