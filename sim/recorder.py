"""Pictures of a trial as a bystander sees it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from preshape.files import atomic_path
from preshape.geometry.camera import Camera
from sim.camera import add_camera, take_colour
from sim.world import World


@dataclass(frozen=True)
class RecorderSettings:
    """How a trial is filmed.

    Args:
        every: a picture is kept of every so many control periods.
        frames_per_s: speed at which they are shown.
        width, height, focal: the bystander's camera, in pixels.
        eye, target: where it stands and looks (m, world).
    """

    every: int = 15
    frames_per_s: float = 8.0
    width: int = 320
    height: int = 240
    focal: float = 420.0
    eye: tuple[float, float, float] = (1.35, -0.75, 1.15)
    target: tuple[float, float, float] = (0.78, 0.0, 0.72)


class Recorder:
    """A spectator that keeps pictures.

    Args:
        settings: how to film.
    """

    def __init__(self, settings: RecorderSettings) -> None:
        self._settings = settings
        self._calls = 0
        self._lens = None
        self.frames: list[UInt8[np.ndarray, "h w 3"]] = []
        self.phases: list[str] = []

    def __call__(self, world: World, phase: str) -> None:
        """Look at the world; every so often keep a picture."""
        self._calls += 1
        if (self._calls - 1) % self._settings.every:
            return
        if self._lens is None:
            s = self._settings
            camera = Camera.looking_at(
                np.array(s.eye), np.array(s.target), width=s.width, height=s.height, focal=s.focal
            )
            self._lens = add_camera(world.scene, camera)
        self.frames.append(take_colour(world.scene, self._lens))
        self.phases.append(phase)

    def save_animation(self, path: Path, caption: str) -> None:
        """Write the pictures as an endless WebP animation with the phase and a caption on each."""
        pictures = [
            annotated(frame, f"{phase} - {caption}")
            for frame, phase in zip(self.frames, self.phases, strict=True)
        ]
        durations = [round(1000 / self._settings.frames_per_s)] * (len(pictures) - 1) + [1500]
        with atomic_path(path) as temporary:
            pictures[0].save(
                temporary,
                format="WEBP",
                save_all=True,
                append_images=pictures[1:],
                duration=durations,
                loop=0,
                quality=60,
            )


def annotated(frame: UInt8[np.ndarray, "h w 3"], caption: str) -> Image.Image:
    """The picture with a caption along its lower edge."""
    picture = Image.fromarray(frame)
    draw = ImageDraw.Draw(picture)
    draw.rectangle((0, picture.height - 15, picture.width, picture.height), fill=(20, 20, 20))
    draw.text((4, picture.height - 14), caption, fill=(255, 255, 255))
    return picture
