"""Patches of scenes, rendered when they are first needed and kept in a cache that anyone may delete."""

import hashlib
import json
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float16

from preshape.data.scene import Scene, SceneRenderer
from preshape.files import atomic_path
from preshape.perception.image import CHANNEL_NAMES
from preshape.perception.observation import Observation
from preshape.perception.patch import PATCH_SIZE, object_centre, object_patch
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.progress import Progress

PERCEPTION_VERSION = 2
"""Raised whenever the way from a view to its patch changes, so that cached patches are made anew."""
MAX_PENDING = 2
"""Rendered views that may wait for perception."""


class PatchCache:
    """Object patches of scenes, in half precision, one file each.

    A file's name is the digest of everything that the patch is a function of: the scene, the renderer, the
    segmentation and the version of perception. So a file is never out of date, only unused.

    Args:
        folder: where the files lie.
        renderer: makes the image of a scene.
        segmentation: how the object is found in it.
    """

    def __init__(
        self, folder: str | Path, renderer: SceneRenderer, segmentation: SegmentationSettings | None = None
    ) -> None:
        self._folder = Path(folder)
        self._renderer = renderer
        self._segmentation = segmentation or SegmentationSettings()

    @cached_property
    def _origin(self) -> list[object]:
        return [self._renderer.fingerprint, asdict(self._segmentation), PERCEPTION_VERSION]

    def path(self, scene: Scene) -> Path:
        """Where the patch of a scene lies, or would lie."""
        text = json.dumps([asdict(scene), self._origin], sort_keys=True, default=np.ndarray.tolist)
        digest = hashlib.sha256(text.encode()).hexdigest()
        return self._folder / digest[:2] / f"{digest}.npy"

    def fill(self, scenes: Sequence[Scene]) -> None:
        """Render what is missing.

        Raises:
            InputError: if no object can be made out in a scene, or the cache cannot be written to.
        """
        missing = [scene for scene in scenes if _open(self.path(scene)) is None]
        if not missing:
            return
        # One thread looks at views while the next is rendered; a second would share Open3D's random numbers.
        with (
            Progress("Rendering", len(missing), "scenes") as progress,
            ThreadPoolExecutor(max_workers=1) as perception,
        ):
            pending: deque[Future[None]] = deque()
            for scene in missing:
                pending.append(perception.submit(self._keep, scene, self._renderer(scene)))
                while len(pending) > MAX_PENDING or (pending and scene is missing[-1]):
                    pending.popleft().result()
                    progress.advance()

    def __getitem__(self, scene: Scene) -> Float16[np.ndarray, "8 400 400"]:
        """The patch of a scene, mapped from its file, which is made if it is missing."""
        patch = _open(self.path(scene))
        if patch is None:
            self._keep(scene, self._renderer(scene))
            patch = _open(self.path(scene))
            assert patch is not None
        return patch

    def _keep(self, scene: Scene, observation: Observation) -> None:
        """Cut the patch out of the view and write it."""
        segmented = segment(observation, self._segmentation)
        centre = object_centre(segmented, observation.camera)
        patch = object_patch(observation, centre)
        with atomic_path(self.path(scene)) as temporary:
            np.save(temporary, patch.astype(np.float16), allow_pickle=False)


def _open(path: Path) -> Float16[np.ndarray, "8 400 400"] | None:
    """The patch in a file; None if there is none, or the file is damaged."""
    try:
        patch = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    fits = patch.dtype == np.float16 and patch.shape == (len(CHANNEL_NAMES), PATCH_SIZE, PATCH_SIZE)
    return patch if fits else None
