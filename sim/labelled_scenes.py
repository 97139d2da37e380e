"""Scenes with what came of their rectangles, from the tables of a data set."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path

from preshape.cornell.layout import HEIGHT, WIDTH
from preshape.cornell.rectangle import GraspRectangle
from preshape.data.joined_tables import joined
from preshape.data.scene import Scene
from preshape.data.tables import read_data_set
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError
from preshape.grasps.rectangle_space import rectangle_of
from preshape.grasps.space import GraspSpace

MAX_IMAGES = 10_000

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class LabelledScene:
    """A scene with what came of its rectangles.

    Args:
        scene: the scene; its number is the image's.
        positives, negatives: rectangles that were executed as they were planned, and lifted or not.
    """

    scene: Scene
    positives: tuple[GraspRectangle, ...]
    negatives: tuple[GraspRectangle, ...]

    def as_commanded(self, command: Callable[[GraspRectangle], GraspRectangle]) -> "LabelledScene":
        """The scene with what the gripper was told in place of what was planned."""
        positives, negatives = (tuple(map(command, own)) for own in (self.positives, self.negatives))
        return replace(self, positives=positives, negatives=negatives)


def labelled_scenes(tables: Sequence[str | Path], space: GraspSpace) -> list[LabelledScene]:
    """The scenes of data sets in which at least one rectangle lifted.

    Args:
        tables: their folders; scenes get the numbers after those of the folder before.
        space: grasp space of theta.

    Raises:
        InputError: if the tables cannot be read, or there are too many scenes for numbers of four digits, or
            another size of image.
    """
    scenes, trials = reduce(joined, (read_data_set(table, space) for table in tables))
    where = " ".join(map(str, tables))
    if max((scene.scene_id for scene in scenes.scenes), default=0) >= MAX_IMAGES:
        raise InputError("The scenes have numbers of five digits", where=where, fix="collect fewer")
    if any((scene.camera.width, scene.camera.height) != (WIDTH, HEIGHT) for scene in scenes.scenes):
        raise InputError(
            f"The images are not of {WIDTH} x {HEIGHT} pixels",
            where=where,
            fix="collect with camera=overhead",
        )
    labelled = [_labelled(scene, trials.executed) for scene in scenes.scenes]
    usable = [own for own in labelled if own.positives]
    log.info("%d of %d scenes have a rectangle that lifted", len(usable), len(labelled))
    return usable


def _labelled(scene: Scene, executed: TrialTable) -> LabelledScene:
    own = executed.where(executed.scene_ids == scene.scene_id)
    rectangles = [rectangle_of(theta) for theta in own.planned]
    positives = tuple(r for r, lifted in zip(rectangles, own.lifted, strict=True) if lifted)
    negatives = tuple(r for r, lifted in zip(rectangles, own.lifted, strict=True) if not lifted)
    return LabelledScene(scene, positives, negatives)
