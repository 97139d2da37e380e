"""The picture of how a trial ended, and many of them on one sheet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from preshape.data.trial import Trial
from preshape.geometry.camera import Camera
from sim.camera import add_camera, take_colour
from sim.world import World

LIFTED_COLOUR, FAILED_COLOUR = (0, 90, 181), (166, 94, 0)
BORDER_PX = 3


class LastLook:
    """A spectator that takes one picture, after the trial is over: it only remembers the world until then."""

    def __init__(self) -> None:
        self._world: World | None = None

    def __call__(self, world: World, phase: str) -> None:
        """Look on."""
        self._world = world

    def picture(self, camera: Camera) -> UInt8[np.ndarray, "h w 3"]:
        """The world as it was left; a world without a renderer, or none, is a defect of the caller."""
        if self._world is None:
            raise ValueError("nothing was looked at")
        return take_colour(self._world.scene, add_camera(self._world.scene, camera))


@dataclass(frozen=True)
class FrameSheetSettings:
    """How last frames are laid out.

    Args:
        columns: pictures side by side.
        caption_px: height of the strip with label, object and number below each.
        font_px: size of its letters.
    """

    columns: int = 10
    caption_px: int = 40
    font_px: float = 10.0


def frame_sheet(
    trials: Sequence[Trial], pictures: Sequence[UInt8[np.ndarray, "h w 3"]], settings: FrameSheetSettings
) -> Image.Image:
    """All pictures in their order, each in a frame and above its trial's label, object and number."""
    height, width = pictures[0].shape[:2]
    tile_width, tile_height = width + 2 * BORDER_PX, height + 2 * BORDER_PX + settings.caption_px
    rows = -(-len(pictures) // settings.columns)
    sheet = Image.new("RGB", (tile_width * settings.columns, tile_height * rows), "white")
    draw = ImageDraw.Draw(sheet)
    for number, (trial, picture) in enumerate(zip(trials, pictures, strict=True)):
        row, column = divmod(number, settings.columns)
        left, top = column * tile_width, row * tile_height
        colour = LIFTED_COLOUR if trial.outcome == "lifted" else FAILED_COLOUR
        draw.rectangle((left, top, left + tile_width - 1, top + height + 2 * BORDER_PX - 1), fill=colour)
        sheet.paste(Image.fromarray(picture), (left + BORDER_PX, top + BORDER_PX))
        place = (left + BORDER_PX, top + height + 2 * BORDER_PX)
        draw.multiline_text(place, _caption(trial), (20, 20, 20), font_size=settings.font_px, spacing=1)
    return sheet


def _caption(trial: Trial) -> str:
    words = trial.object_id.split("_")
    half = (len(words) + 1) // 2
    name = f"{' '.join(words[:half])}\n{' '.join(words[half:])}"
    return f"{trial.outcome.value.upper()}, {trial.face.value.split('_')[0]}, {trial.trial_id}\n{name}"
