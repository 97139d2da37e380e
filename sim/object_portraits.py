"""Portraits of single objects, and all objects of a set on one sheet."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sapien
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.geometry.camera import Camera
from sim.camera import add_camera, segmentation, take_colour
from sim.objects.actor import add_object
from sim.objects.object_model import ObjectModel, ObjectSet
from sim.scene_systems import make_render_system

SUPERSAMPLING = 2
FORMATS = (".webp", ".png", ".jpg")


@dataclass(frozen=True)
class PortraitSettings:
    """How an object is portrayed.

    Args:
        width_px, height_px: of the picture.
        direction: from the object to the camera, in the object's frame.
        on_flat_things: how much more one that is all breadth and no height is looked down on.
        distance: from the object to the camera, over the object's diagonal.
        background: sRGB, 0-255.
    """

    width_px: int = 168
    height_px: int = 168
    direction: tuple[float, float, float] = (1.0, 0.32, 0.5)
    on_flat_things: float = 0.9
    distance: float = 3.5
    background: tuple[int, int, int] = (236, 236, 232)


@dataclass(frozen=True)
class SheetSettings:
    """How portraits are laid out.

    Args:
        columns: portraits side by side.
        caption_px: height of the strip for the name below each.
        font_px: size of its letters.
    """

    columns: int = 14
    caption_px: int = 30
    font_px: float = 10.0


@dataclass(frozen=True)
class SheetFile:
    """Where a sheet is written, in the format that the name says.

    Args:
        path: ends with one of `FORMATS`.
        quality: of its compression, 0-100; PNG has no losses.

    Raises:
        InputError: if the name ends otherwise.
    """

    path: Path
    quality: int

    def __post_init__(self) -> None:
        if self.path.suffix not in FORMATS:
            fix = f"choose one of {', '.join(FORMATS)}"
            raise InputError("The picture's name does not end with a known format", where=self.path, fix=fix)

    def save(self, sheet: Image.Image) -> None:
        """Write a sheet; raises `InputError` if the place cannot be written to."""
        with atomic_path(self.path) as temporary:
            sheet.save(temporary, quality=self.quality, method=6)


def contact_sheet(objects: ObjectSet, portraits: PortraitSettings, sheet: SheetSettings) -> Image.Image:
    """The portraits of all objects of a set in alphabetic order, each with its name."""
    width, height = portraits.width_px, portraits.height_px + sheet.caption_px
    rows = -(-len(objects.names) // sheet.columns)
    page = Image.new("RGB", (width * sheet.columns, height * rows), "white")
    draw = ImageDraw.Draw(page)
    for number, name in enumerate(objects.names):
        row, column = divmod(number, sheet.columns)
        corner = (column * width, row * height)
        page.paste(Image.fromarray(portrait(objects.load(name), portraits)), corner)
        lines = _wrapped(draw, name.replace("_", " "), width - 8, sheet.font_px)
        place = (corner[0] + width / 2, corner[1] + portraits.height_px + 2)
        draw.multiline_text(
            place, lines, (20, 20, 20), font_size=sheet.font_px, anchor="ma", align="center", spacing=1
        )
    return page


def portrait(model: ObjectModel, settings: PortraitSettings) -> UInt8[np.ndarray, "h w 3"]:
    """The object alone, filling the picture."""
    scene = sapien.Scene([make_render_system()])
    scene.set_ambient_light([0.55] * 3)
    scene.add_directional_light([-1.0, 0.3, -1.2], [1.5] * 3)
    scene.add_directional_light([-0.2, -1.0, -0.4], [0.5] * 3)
    entity = add_object(scene, model, np.eye(4))
    middle, diagonal = model.bounds.mean(axis=0), float(np.linalg.norm(model.size))
    towards = np.array(settings.direction)
    towards[2] += settings.on_flat_things * max(0.0, 1 - model.size[2] / model.size[:2].max())
    towards /= np.linalg.norm(towards)
    width, height = (SUPERSAMPLING * pixels for pixels in (settings.width_px, settings.height_px))
    camera = Camera.looking_at(
        middle + towards * settings.distance * diagonal,
        middle,
        width=width,
        height=height,
        focal=settings.distance * min(width, height),
    )
    lens = add_camera(scene, camera)
    picture = take_colour(scene, lens)
    picture[segmentation(lens) != entity.per_scene_id] = settings.background
    return np.asarray(Image.fromarray(picture).reduce(SUPERSAMPLING))


def _wrapped(draw: ImageDraw.ImageDraw, text: str, width: float, font_px: float) -> str:
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if draw.textlength(longer, font_size=font_px) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return "\n".join(lines)
