"""More examples from few: mirrored images, moved rectangles, other light, rectangles of the background."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_metric import angle_between, jaccard
from preshape.grasps.rectangle_space import JAW_PX, OPENING_PX
from preshape.perception.image import NORMALS
from preshape.perception.view_batch import ViewBatch

COLOURS = 3
"""Channels of an image that are colours."""
NEARLY_RAD, NEARLY_JACCARD = math.radians(45), 0.1
"""A rectangle is background if no positive one is nearer to it than this, in angle and overlap."""
DRAWS = 50
"""So often a rectangle of the background is drawn until one is found."""


@dataclass(frozen=True)
class Augmentation:
    """How examples are varied in training. The paper has mirrored images alone.

    Args:
        mirrored: left and right exchanged in half of the examples, in the image and in the rectangle.
        half_turned: half of the rectangles are turned by half a turn: the same grasp, other numbers.
        shift_px, turn_rad, opening: standard deviations by which rectangles are moved, turned, and opened
            (of the opening's logarithm).
        light: standard deviation of the gain of each colour, and of what is added to all (colours are 0-1).
        background: share of a batch that is added as rectangles of the background, which fail.
        background_px: how far their centres may lie beyond the positive rectangles' centres.
    """

    mirrored: bool = True
    half_turned: bool = False
    shift_px: float = 0.0
    turn_rad: float = 0.0
    opening: float = 0.0
    light: float = 0.0
    background: float = 0.0
    background_px: float = 60.0

    def moved(self, theta: Float[Tensor, "b 4"], rng: np.random.Generator) -> Float[Tensor, "b 4"]:
        """The same grasps a little elsewhere, and half of them half a turn on."""
        noise = torch.from_numpy(rng.standard_normal(theta.shape)).to(theta)
        moved = theta + noise * theta.new_tensor([self.shift_px, self.shift_px, self.turn_rad, 0.0])
        moved[:, 3] *= (self.opening * noise[:, 3]).exp()
        if self.half_turned:
            moved[:, 2] += math.pi * torch.from_numpy(rng.integers(0, 2, len(theta))).to(theta)
        return moved

    def seen_otherwise(
        self, view: ViewBatch, theta: Float[Tensor, "b 4"], rng: np.random.Generator
    ) -> Float[Tensor, "b 4"]:
        """Change views in place: put them into another light, and mirror half of them; theta after that."""
        if self.light:
            noise = torch.from_numpy(self.light * rng.standard_normal((len(theta), 4))).to(theta)
            colours = view.patch[:, :COLOURS]
            colours.mul_(1 + noise[:, :3, None, None]).add_(noise[:, 3:, None, None]).clamp_(0, 1)
        if not self.mirrored:
            return theta
        mirrored = torch.from_numpy(rng.integers(0, 2, len(theta)).astype(bool))
        for row in mirrored.nonzero()[:, 0].tolist():
            mirror(view, row)
        return torch.where(mirrored[:, None], mirrored_theta(theta), theta)

    def drawn_background(
        self, positives: Sequence[GraspRectangle], rng: np.random.Generator
    ) -> Float[np.ndarray, "4"] | None:
        """Theta of a random rectangle about an object at which nobody would grasp it; None if none is found.

        Args:
            positives: labelled positive rectangles of the image, at least one.
            rng: source of the draws.
        """
        centres = np.array([(own.u, own.v) for own in positives])
        low = np.maximum(centres.min(axis=0) - self.background_px, 0)
        high = np.minimum(centres.max(axis=0) + self.background_px, (WIDTH - 1, HEIGHT - 1))
        for _ in range(DRAWS):
            u, v = rng.uniform(low, high)
            opening = float(np.exp(rng.uniform(*np.log(OPENING_PX))))
            drawn = GraspRectangle(float(u), float(v), rng.uniform(0, math.pi), opening, JAW_PX)
            if is_background(drawn, positives):
                return np.array([u, v, drawn.angle_rad, opening])
        return None


def is_background(rectangle: GraspRectangle, positives: Sequence[GraspRectangle]) -> bool:
    """Whether a rectangle is not even nearly what anyone labelled as positive."""
    return all(
        angle_between(rectangle, own) > NEARLY_RAD or jaccard(rectangle, own) < NEARLY_JACCARD
        for own in positives
    )


def mirror(view: ViewBatch, row: int) -> None:
    """Exchange left and right in one of the views: its image, its normals, its camera and its table."""
    image = view.patch[row].flip(-1)
    image[NORMALS.start] *= -1
    view.patch[row] = image
    view.intrinsics[row, 2] = image.shape[-1] - 1 - view.intrinsics[row, 2]
    view.table[row, 0] *= -1


def mirrored_theta(theta: Float[Tensor, "b 4"], width: int = WIDTH) -> Float[Tensor, "b 4"]:
    """The same grasps in mirrored images, as `GraspRectangle.mirrored`."""
    u, v, angle, opening = theta.unbind(dim=1)
    return torch.stack((width - 1 - u, v, -angle, opening), dim=1)
