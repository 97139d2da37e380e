"""A film of a trial as a strip of pictures."""

from pathlib import Path

from PIL import Image, UnidentifiedImageError

from preshape.errors import InputError
from preshape.files import atomic_path

MOMENTS = (0.0, 0.4, 0.7, 1.0)
"""Which pictures are taken, as shares of the film."""
GAP_PX = 6


def save_film_strip(film: Path, path: Path) -> None:
    """Put four pictures of a film side by side into a PNG, atomically.

    Raises:
        InputError: if the film cannot be read or the picture not be written.
    """
    frames = _frames(film)
    width, height = frames[0].size
    strip = Image.new("RGB", (len(frames) * (width + GAP_PX) - GAP_PX, height), (255, 255, 255))
    for number, frame in enumerate(frames):
        strip.paste(frame, (number * (width + GAP_PX), 0))
    with atomic_path(path) as temporary:
        strip.save(temporary, format="PNG", optimize=True)


def _frames(film: Path) -> list[Image.Image]:
    try:
        with Image.open(film, formats=("WEBP",)) as image:
            last = getattr(image, "n_frames", 1) - 1
            frames = []
            for moment in MOMENTS:
                image.seek(round(moment * last))
                frames.append(image.convert("RGB"))
            return frames
    except (OSError, UnidentifiedImageError, EOFError, ValueError) as error:
        raise InputError(
            f"The film cannot be read ({error})", where=film, fix="run the command that made it again"
        ) from error
