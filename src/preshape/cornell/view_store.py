"""Views of the data set's images, made when they are first needed and kept in a cache that may be deleted."""

import hashlib
import io
from dataclasses import astuple
from pathlib import Path

import numpy as np
from jaxtyping import Float16

from preshape.cornell.layout import ImageFiles
from preshape.cornell.rectangle_views import RectangleViewSettings, rectangle_image
from preshape.cornell.views import load_cornell_view
from preshape.data.bounded_folder import BoundedFolder
from preshape.source_digest import source_digest


class ViewStore:
    """8-channel images in half precision, one file each.

    A file's name is the digest of the image's files (place, size, time of change), of the settings and of
    the code that makes it.

    Args:
        folder: where the files lie.
        settings: how an image becomes a view.
        max_gigabytes: how much the files may take (10^9 bytes); the least recently used ones go first.
    """

    def __init__(
        self, folder: str | Path, settings: RectangleViewSettings, max_gigabytes: float = 10.0
    ) -> None:
        self.settings = settings
        self._files = BoundedFolder(folder, round(max_gigabytes * 1e9))

    def image(self, files: ImageFiles) -> Float16[np.ndarray, "8 h w"]:
        """The view of an image, which is made if its file is missing or damaged.

        Raises:
            InputError: if a file of the image is missing, truncated or damaged, or the folder cannot be
                written to.
        """
        name = self._name(files)
        content = self._files.read(name)
        image = None if content is None else _decoded(content)
        if image is None:
            view = load_cornell_view(files).observation
            image = rectangle_image(view, self.settings).astype(np.float16)
            buffer = io.BytesIO()
            np.save(buffer, image, allow_pickle=False)
            self._files.write(name, buffer.getvalue())
        return image

    def _name(self, files: ImageFiles) -> str:
        status = ((path.resolve(), path.stat()) for path in files.pictures)
        parts = [(str(path), own.st_size, own.st_mtime_ns) for path, own in status]
        text = repr((parts, astuple(self.settings), source_digest(__name__)))
        return f"{hashlib.sha256(text.encode()).hexdigest()}.npy"


def _decoded(content: bytes) -> Float16[np.ndarray, "8 h w"] | None:
    try:
        image = np.load(io.BytesIO(content), allow_pickle=False)
    except (ValueError, OSError, EOFError):
        return None
    return image if image.dtype == np.float16 and image.ndim == 3 else None
