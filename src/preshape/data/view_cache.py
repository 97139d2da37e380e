"""Views of scenes, rendered when they are first needed and kept in a cache that anyone may delete."""

import hashlib
import json
import random
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import cached_property
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float16

from preshape.data.bounded_folder import BoundedFolder
from preshape.data.scene import Scene, SceneRenderer
from preshape.data.view_cache_files import (
    CLOUD_BYTES,
    TYPICAL_PATCH_BYTES,
    decode_cloud,
    decode_patch,
    encode_cloud,
    encode_patch,
)
from preshape.errors import InputError
from preshape.perception.object_view import ObjectCloud, object_cloud, object_patch
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.progress import Progress
from preshape.source_digest import source_digest

Part = Literal["cloud", "patch"]


class ViewCache:
    """Object views of scenes: for each a small file with the cloud and a large one with the patch.

    Networks that do not look at patches need neither the large files nor the time that they take. A file's
    name is the digest of everything that the view is a function of: the scene without its number, the
    renderer, the segmentation and the code. So a file is never out of date, only unused. Several processes
    may share the folder, and it may be deleted while they do.

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

    def path(self, scene: Scene, part: Part) -> Path:
        """Where a part of the view of a scene lies, or would lie."""
        return self._files.path(self._name(scene, part))

    def holds(self, scene: Scene, *, with_patch: bool) -> bool:
        """Whether the cloud of a scene is there, and its patch if that is asked for; both count as used."""
        cloud = self._files.use(self._name(scene, "cloud"))
        return cloud and (not with_patch or self._files.use(self._name(scene, "patch")))

    def fill(self, scenes: Sequence[Scene], *, with_patches: bool) -> None:
        """Make what is missing; goes on where an interrupted filling stopped.

        Args:
            scenes: whose views are needed.
            with_patches: whether their patches are needed, too.

        Raises:
            InputError: if the scenes are more than the cache may hold, no object can be made out in one of
                them, or the cache cannot be written to.
        """
        needed = len(scenes) * (CLOUD_BYTES + (TYPICAL_PATCH_BYTES if with_patches else 0))
        if needed > self._files.max_bytes:
            raise InputError(
                f"The views of {len(scenes)} scenes take {needed / 1e9:.1f} GB, but the cache may hold "
                f"{self._files.max_bytes / 1e9:.1f} GB",
                where=self._files.folder,
                fix="allow more with dataset.data.views.max_gigabytes=...",
            )
        missing = [scene for scene in scenes if not self.holds(scene, with_patch=with_patches)]
        # In any order, so that processes that fill the same cache at the same time share the work.
        random.shuffle(missing)
        if missing:
            with Progress("Rendering", len(scenes), "scenes", done=len(scenes) - len(missing)) as progress:
                for _ in self._maker(self, missing, with_patches=with_patches):
                    progress.advance()

    def make(self, scene: Scene, *, with_patch: bool) -> None:
        """Render the view of a scene and write it; does nothing if another process was faster.

        Raises:
            InputError: if no object can be made out in the scene, or the cache cannot be written to.
        """
        if self.holds(scene, with_patch=with_patch):
            return
        if with_patch:
            self._make_patch(scene)
        else:
            self._make_cloud(scene)

    def cloud(self, scene: Scene) -> ObjectCloud:
        """The object's cloud in a scene, which is made if its file is missing or damaged."""
        content = self._files.read(self._name(scene, "cloud"))
        cloud = None if content is None else decode_cloud(content)
        return self._make_cloud(scene)[0] if cloud is None else cloud

    def patch(self, scene: Scene) -> Float16[np.ndarray, "8 h w"]:
        """The object's patch in a scene, which is made if its file is missing or damaged."""
        content = self._files.read(self._name(scene, "patch"))
        patch = None if content is None else decode_patch(content)
        return self._make_patch(scene) if patch is None else patch

    def _make_cloud(self, scene: Scene) -> tuple[ObjectCloud, Observation]:
        observation = self._renderer(scene)
        cloud = object_cloud(segment(observation, self._segmentation))
        self._files.write(self._name(scene, "cloud"), encode_cloud(cloud))
        return cloud, observation

    def _make_patch(self, scene: Scene) -> Float16[np.ndarray, "8 h w"]:
        cloud, observation = self._make_cloud(scene)
        patch = object_patch(observation, cloud.centre(observation.camera)).astype(np.float16)
        self._files.write(self._name(scene, "patch"), encode_patch(patch))
        return patch

    @cached_property
    def _origin(self) -> list[object]:
        return [self._renderer.fingerprint, asdict(self._segmentation), source_digest(__name__)]

    def _name(self, scene: Scene, part: Part) -> str:
        # Its number changes when tables are joined, its image does not.
        seen = {key: value for key, value in asdict(scene).items() if key != "scene_id"}
        text = json.dumps([seen, self._origin], sort_keys=True, default=np.ndarray.tolist)
        return f"{hashlib.sha256(text.encode()).hexdigest()}.{part}"


class ViewMaker(Protocol):
    """Makes the views of many scenes."""

    def __call__(self, cache: ViewCache, scenes: Sequence[Scene], *, with_patches: bool) -> Iterator[Scene]:
        """Make them in any order; yields each scene when its view is there."""
        ...


def one_by_one(cache: ViewCache, scenes: Sequence[Scene], *, with_patches: bool) -> Iterator[Scene]:
    """Make views in this process."""
    for scene in scenes:
        cache.make(scene, with_patch=with_patches)
        yield scene
