"""A renderer that remembers the last scene it was shown."""

from preshape.data.scene import Scene, SceneRenderer
from preshape.perception.observation import Observation


class LastView:
    """A `preshape.data.scene.SceneRenderer` for those who look at a scene again and again.

    Args:
        renderer: makes the views.
    """

    def __init__(self, renderer: SceneRenderer) -> None:
        self._renderer = renderer
        self._last: tuple[Scene, Observation] | None = None

    @property
    def fingerprint(self) -> str:
        """The renderer's."""
        return self._renderer.fingerprint

    def __call__(self, scene: Scene) -> Observation:
        """The view of a scene."""
        if self._last is None or self._last[0] is not scene:
            self._last = scene, self._renderer(scene)
        return self._last[1]
