"""The learning rate of short trainings: up, and down along a cosine."""

from torch.optim import Optimizer
from torch.optim.lr_scheduler import OneCycleLR

RISE = 0.1
"""Share of a training in which the rate rises."""


def one_cycle(optimizer: Optimizer, highest: float, steps: int) -> OneCycleLR:
    """A cycle of so many steps (Smith and Topin 2018), however few.

    Args:
        optimizer: whose learning rate is set.
        highest: the learning rate at the end of the rise.
        steps: how often the rate is asked for, from the first batch on.
    """
    # PyTorch divides by the steps of the rise less one.
    rise = min(max(RISE, 1.5 / steps), 0.9)
    return OneCycleLR(optimizer, highest, total_steps=steps, pct_start=rise)
