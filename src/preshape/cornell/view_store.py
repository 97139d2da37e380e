"""Views of the data set's images, made when they are first needed and kept in a cache that may be deleted."""

import hashlib
import io
from dataclasses import astuple
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from preshape.cornell.layout import ImageFiles
from preshape.cornell.rectangle_views import RectangleView, RectangleViewSettings, rectangle_view
from preshape.cornell.views import load_cornell_view
from preshape.data.bounded_folder import BoundedFolder
from preshape.source_digest import source_digest


class ViewStore:
    """Views with images in half precision, one file each.

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

    def view(self, files: ImageFiles) -> RectangleView:
        """The view of an image, which is made if its file is missing or damaged.

        Raises:
            InputError: if a file of the image is missing, truncated or damaged, or the folder cannot be
                written to.
        """
        name = self._name(files)
        content = self._files.read(name)
        view = None if content is None else _decoded(content)
        if view is None:
            view = rectangle_view(load_cornell_view(files).observation, self.settings)
            view = view._replace(image=view.image.astype(np.float16))
            buffer = io.BytesIO()
            np.savez(buffer, **view._asdict())
            self._files.write(name, buffer.getvalue())
        return view

    def _name(self, files: ImageFiles) -> str:
        status = ((path.resolve(), path.stat()) for path in files.pictures)
        parts = [(str(path), own.st_size, own.st_mtime_ns) for path, own in status]
        text = repr((parts, astuple(self.settings), source_digest(__name__)))
        return f"{hashlib.sha256(text.encode()).hexdigest()}.npz"


def _decoded(content: bytes) -> RectangleView | None:
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            view = RectangleView(**arrays)
    except (ValueError, OSError, EOFError, TypeError, BadZipFile):
        return None
    whole = view.image.dtype == np.float16 and view.image.ndim == 3
    return view if whole and view.intrinsics.shape == view.table.shape == (4,) else None
