"""Executed rectangles as a folder in the layout of the Cornell grasp data set, derived from their tables."""

import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Bool

from preshape.cornell.layout import HEIGHT, OBJECT_LISTS, WIDTH
from preshape.data.scene import SceneRenderer
from preshape.data.tables import data_hash
from preshape.errors import InputError
from preshape.files import atomic_path, exclusive, read_json, write_json
from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace
from sim.cornell_image import image_paths, write_image
from sim.job_list import do_jobs
from sim.labelled_scenes import LabelledScene, labelled_scenes
from sim.rectangle_grasps import RectangleGrasps
from sim.stretched_objects import original_of
from sim.table import TableSettings
from sim.workers import BeginStep, Work, available_cores

IMAGES, MADE_FROM, LOCK = "01", "made_from.json", "making.lock"
BACKGROUND = "pcdb_0000"
IMAGES_PER_WORKER = 30
"""Fewer are not worth another process, which needs some seconds to start."""


@dataclass(frozen=True, eq=False)
class SimulatedCornell:
    """Makes the folder: a `preshape.cornell.data_module.FolderMaker`.

    Rectangles are written as the gripper executed them: an opening that it does not have is the nearest that
    it has, so that both jaws are where the image shows them. Scenes in which nothing was lifted are left out,
    because every image there has a positive rectangle.

    Args:
        table: folder with `scenes.parquet` and `trials.parquet`.
        space: what theta means in them.
        renderer: makes the scenes' images.
        meaning: how the gripper executed them.
        table_settings: the table on which it did.
        base_height_m: height of the robot's base over the floor; points are written in its frame.
        added: folders of further tables, which are put behind the first.
        margin_px: points are written so far around the object; all of them would be 10 MB an image.
        workers: number of processes; None takes every core.
    """

    table: str | Path
    space: GraspSpace
    renderer: SceneRenderer
    meaning: RectangleGrasps
    table_settings: TableSettings
    base_height_m: float
    added: Sequence[str | Path] = ()
    margin_px: int = 160
    workers: int | None = None

    def __call__(self, root: Path) -> None:
        """Make the images that are missing in a folder; goes on where an interrupted call stopped.

        A folder that was made from other tables or by other settings is made anew.

        Args:
            root: the folder.

        Raises:
            InputError: if the tables cannot be read, or the folder holds something else or cannot be written.
        """
        with exclusive(root / LOCK):
            self._prepare(root)
            labelled = labelled_scenes(self._tables, self.space)
            scenes = {own.scene.scene_id: own for own in labelled}
            missing = [n for n in sorted(scenes) if not _complete(root / IMAGES, n)]
            if missing:
                self._write(root, {number: scenes[number] for number in missing})
            _write_objects(root, labelled)

    @property
    def _tables(self) -> tuple[str | Path, ...]:
        return (self.table, *self.added)

    def _prepare(self, root: Path) -> None:
        made_from = {
            "tables": data_hash(*self._tables),
            "renderer": self.renderer.fingerprint,
            "meaning": asdict(self.meaning),
            "base_height_m": self.base_height_m,
            "margin_px": self.margin_px,
        }
        path = root / MADE_FROM
        if path.is_file() and read_json(path) == made_from:
            return
        if not path.is_file() and any(entry.name != LOCK for entry in root.iterdir()):
            raise InputError(
                "The folder holds something else", where=root, fix="give another one, or an empty one"
            )
        shutil.rmtree(root / IMAGES, ignore_errors=True)
        write_json(path, made_from)

    def _write(self, root: Path, scenes: dict[int, LabelledScene]) -> None:
        count = min(self.workers or available_cores(), -(-len(scenes) // IMAGES_PER_WORKER))
        if count <= 1:
            for labelled in scenes.values():
                self.write(root / IMAGES, labelled)
            return
        build = partial(_writing, self, root / IMAGES, scenes)
        jobs = do_jobs("Writing", build, list(scenes), unit="images", workers=count)
        failed = [number for number, done in jobs if done is None]
        if failed:
            raise InputError(
                f"{len(failed)} images cannot be made, such as that of scene {failed[0]}",
                where=root,
                fix="look at the warnings above and start again",
            )

    def write(self, folder: Path, labelled: LabelledScene) -> None:
        """Write one image.

        Raises:
            InputError: if the place cannot be written to.
        """
        view = self.renderer(labelled.scene)
        labelled = labelled.as_commanded(
            lambda own: self.meaning.commanded(labelled.scene, own, self.table_settings, view)
        )
        shown = _around(view.mask, self.margin_px)
        T_base_world = make_pose(np.eye(3), np.array([0.0, 0.0, -self.base_height_m]))
        write_image(
            folder,
            labelled.scene.scene_id,
            view,
            labelled.positives,
            labelled.negatives,
            T_base_world,
            shown,
        )


def _around(mask: Bool[np.ndarray, "h w"] | None, margin_px: int) -> Bool[np.ndarray, "h w"]:
    """Pixels of the rectangle around an object, and so far beside it; all where no object is known."""
    shown = np.ones((HEIGHT, WIDTH), dtype=bool)
    if mask is None or not mask.any():
        return shown
    for axis in (0, 1):
        along = np.flatnonzero(mask.any(axis=1 - axis))
        places = np.arange(mask.shape[axis])
        near = (places >= along[0] - margin_px) & (places <= along[-1] + margin_px)
        shown &= near[:, None] if axis == 0 else near[None, :]
    return shown


def _complete(folder: Path, number: int) -> bool:
    return all(path.is_file() for path in image_paths(folder, number).values())


def _write_objects(root: Path, scenes: list[LabelledScene]) -> None:
    """The list of objects, with a line for each rectangle.

    An object's number is its place by name. Stretched copies of an object count as that object, so that no
    part of the images can hold a copy of what another part tests.
    """
    names = sorted({original_of(labelled.scene.object_id) for labelled in scenes})
    lines = []
    for labelled in scenes:
        name = original_of(labelled.scene.object_id)
        line = f"{labelled.scene.scene_id:04d} {names.index(name)} {name} {BACKGROUND}\n"
        lines += [line] * (len(labelled.positives) + len(labelled.negatives))
    with atomic_path(root / OBJECT_LISTS[0]) as temporary:
        temporary.write_text("".join(lines), encoding="ascii")


def _writing(maker: SimulatedCornell, folder: Path, scenes: dict[int, LabelledScene]) -> Work[int, bool]:
    def work(number: int, _begin: BeginStep) -> bool:
        maker.write(folder, scenes[number])
        return True

    return work
