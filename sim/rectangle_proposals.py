"""Grasp rectangles to try on a scene: the paper's initial ones, aligned ones, and any around the object."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np
from jaxtyping import Bool, Float

from preshape.data.trial import Face
from preshape.geometry.camera import Camera
from preshape.grasps.heuristic import InitialGrasp
from preshape.perception.segmentation import SegmentedObject

DIRECTIONS = 18
"""In which the width of an object is measured."""


@dataclass(frozen=True)
class RectangleProposals:
    """Rectangles (u, v, angle, opening) around the segmented object.

    The initial ones are the paper's (section 4.5). Every second one of the others is aligned to where the
    object is narrow, with a little error. Between them, in turn, one lies on the object and one anywhere
    around it, turned and opened at random, so that a network sees failures of all kinds.

    Args:
        starts: number of initial rectangles.
        opening_px: opening of the initial ones.
        explored: number of the others.
        openings_px: range of the openings of those that are not aligned.
        margins_px: range of what an aligned rectangle is wider than the object.
        angle_noise_rad, centre_noise_px: standard deviations of the error of aligned rectangles.
        jaw_px: width of the jaws in the image.
        level_m: aligned rectangles regard what of the object is no lower than this below the point that they
            are aligned around: the gripper's fingers do not meet the rest, though the camera sees it.
        around_px: how far beside the object a rectangle may lie.
    """

    starts: int
    opening_px: float
    explored: int
    openings_px: tuple[float, float]
    margins_px: tuple[float, float]
    angle_noise_rad: float
    centre_noise_px: float
    jaw_px: float
    level_m: float
    around_px: float

    @property
    def most(self) -> int:
        """See `GraspProposals`."""
        return self.starts + self.explored

    def initial(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """At the centre of the segmented object with random orientations."""
        centre = _pixels(segmented.mask).mean(axis=0)
        angles = rng.uniform(0.0, np.pi, size=self.starts)
        return [_grasp(centre, float(angle), self.opening_px) for angle in angles]

    def strayed(
        self, segmented: SegmentedObject, camera: Camera, rng: np.random.Generator
    ) -> list[InitialGrasp]:
        """Aligned ones, ones on the object and ones around it, in turn."""
        return list(islice(self._endless(segmented, rng), self.explored))

    def _endless(self, segmented: SegmentedObject, rng: np.random.Generator) -> Iterator[InitialGrasp]:
        pixels = _pixels(segmented.mask)
        heights = segmented.points @ segmented.plane[:3]
        low, high = pixels.min(axis=0) - self.around_px, pixels.max(axis=0) + self.around_px
        for kind in cycle(("aligned", "on", "aligned", "around")):
            k = rng.integers(len(pixels))
            if kind == "aligned":
                yield self._aligned(pixels[heights > heights[k] - self.level_m], pixels[k], rng)
            else:
                centre = pixels[k] if kind == "on" else rng.uniform(low, high)
                yield _grasp(centre, rng.uniform(0.0, np.pi), rng.uniform(*self.openings_px))

    def _aligned(
        self, pixels: Float[np.ndarray, "n 2"], point: Float[np.ndarray, "2"], rng: np.random.Generator
    ) -> InitialGrasp:
        """Across the object where it is narrowest around a point of it."""
        angles = np.arange(DIRECTIONS) * np.pi / DIRECTIONS
        ends = [self._ends(pixels - point, float(angle)) for angle in angles]
        k = int(np.argmin([high - low for low, high in ends]))
        low, high = ends[k]
        middle = point + (low + high) / 2 * np.array([np.cos(angles[k]), np.sin(angles[k])])
        centre = middle + rng.normal(0.0, self.centre_noise_px, size=2)
        angle = angles[k] + rng.normal(0.0, self.angle_noise_rad)
        return _grasp(centre, float(angle), high - low + rng.uniform(*self.margins_px))

    def _ends(self, offsets: Float[np.ndarray, "n 2"], angle: float) -> tuple[float, float]:
        """How far the object reaches in a direction, and against it, in a strip as wide as the jaws (px)."""
        along = offsets @ np.array([np.cos(angle), np.sin(angle)])
        across = offsets @ np.array([-np.sin(angle), np.cos(angle)])
        strip = along[np.abs(across) <= self.jaw_px / 2]
        return float(strip.min()), float(strip.max())


def _pixels(mask: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "n 2"]:
    """Coordinates (u, v) of the mask's pixels."""
    return np.argwhere(mask)[:, ::-1].astype(np.float64)


def _grasp(centre: Float[np.ndarray, "2"], angle: float, opening: float) -> InitialGrasp:
    """A rectangle as theta; its angle is kept within [0, pi)."""
    return InitialGrasp(np.array([*centre, angle % np.pi, opening]), Face.TOP)
