"""Views of scenes, rendered when they are first needed and kept in a cache that anyone may delete."""

import hashlib
import json
import random
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np

from preshape.data.bounded_folder import BoundedFolder
from preshape.data.scene import Scene, SceneRenderer
from preshape.data.view_cache_files import CLOUD_BYTES, TYPICAL_BYTES, decode, decode_cloud, encode
from preshape.errors import InputError
from preshape.perception.object_view import ObjectCloud, ObjectView, object_view
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.progress import Progress
from preshape.source_digest import source_digest


class ViewCache:
    """Object views of scenes, their patches in half precision, one file each.

    A file's name is the digest of everything that the view is a function of: the scene, the renderer, the
    segmentation and the code. So a file is never out of date, only unused. Several processes may share the
    folder, and it may be deleted while they do.

    Args:
        folder: where the files lie.
        renderer: makes the image of a scene.
        max_gigabytes: how much the files may take (10^9 bytes); the least recently used ones go first.
        segmentation: how the object is found in an image.
        maker: makes the views of many scenes.
    """

    def __init__(
        self,
        folder: str | Path,
        renderer: SceneRenderer,
        max_gigabytes: float = 10.0,
        segmentation: SegmentationSettings | None = None,
        maker: "ViewMaker | None" = None,
    ) -> None:
        self._files = BoundedFolder(folder, round(max_gigabytes * 1e9))
        self._renderer = renderer
        self._segmentation = segmentation or SegmentationSettings()
        self._maker = maker or one_by_one

    def path(self, scene: Scene) -> Path:
        """Where the view of a scene lies, or would lie."""
        return self._files.path(self._name(scene))

    def holds(self, scene: Scene) -> bool:
        """Whether there is a file for the scene, which then counts as used."""
        return self._files.use(self._name(scene))

    def fill(self, scenes: Sequence[Scene]) -> None:
        """Make what is missing; goes on where an interrupted filling stopped.

        Raises:
            InputError: if the scenes are more than the cache may hold, no object can be made out in one of
                them, or the cache cannot be written to.
        """
        needed = len(scenes) * TYPICAL_BYTES
        if needed > self._files.max_bytes:
            raise InputError(
                f"The views of {len(scenes)} scenes take {needed / 1e9:.1f} GB, but the cache may hold "
                f"{self._files.max_bytes / 1e9:.1f} GB",
                where=self._files.folder,
                fix="allow more with dataset.data.views.max_gigabytes=...",
            )
        missing = [scene for scene in scenes if not self.holds(scene)]
        # In any order, so that processes that fill the same cache at the same time share the work.
        random.shuffle(missing)
        if missing:
            with Progress("Rendering", len(scenes), "scenes", done=len(scenes) - len(missing)) as progress:
                for _ in self._maker(self, missing):
                    progress.advance()

    def make(self, scene: Scene) -> ObjectView:
        """Render the view of a scene and write it.

        Raises:
            InputError: if no object can be made out in the scene, or the cache cannot be written to.
        """
        observation = self._renderer(scene)
        view = object_view(observation, segment(observation, self._segmentation))
        self._files.write(self._name(scene), encode(view))
        return ObjectView(view.channels.astype(np.float16), view.cloud)

    def __getitem__(self, scene: Scene) -> ObjectView:
        """The view of a scene, which is made if its file is missing or damaged."""
        content = self._files.read(self._name(scene))
        view = None if content is None else decode(content)
        return self.make(scene) if view is None else view

    def cloud(self, scene: Scene) -> ObjectCloud:
        """The object's cloud alone, which is much less to read."""
        content = self._files.read(self._name(scene), CLOUD_BYTES)
        cloud = None if content is None else decode_cloud(content)
        return self.make(scene).cloud if cloud is None else cloud

    @cached_property
    def _origin(self) -> list[object]:
        return [self._renderer.fingerprint, asdict(self._segmentation), source_digest(__name__)]

    def _name(self, scene: Scene) -> str:
        text = json.dumps([asdict(scene), self._origin], sort_keys=True, default=np.ndarray.tolist)
        return f"{hashlib.sha256(text.encode()).hexdigest()}.view"


class ViewMaker(Protocol):
    """Makes the views of many scenes."""

    def __call__(self, cache: ViewCache, scenes: Sequence[Scene]) -> Iterator[Scene]:
        """Make them in any order; yields each scene when its view is there."""
        ...


def one_by_one(cache: ViewCache, scenes: Sequence[Scene]) -> Iterator[Scene]:
    """Make views in this process; those that another process made in the meantime are left to it."""
    for scene in scenes:
        if not cache.holds(scene):
            cache.make(scene)
        yield scene
