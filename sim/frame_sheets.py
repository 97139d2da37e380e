"""Photographing how recorded trials end, in worker processes, and putting the pictures on sheets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from preshape.data.trial import Trial, TrialOutcome
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.files import atomic_path
from preshape.geometry.camera import Camera
from sim.job_list import do_jobs
from sim.laboratory import LaboratoryFactory
from sim.last_frame import FrameSheetSettings, LastLook, frame_sheet
from sim.repetition import find_trials, repeat
from sim.workers import BeginStep, Work


@dataclass(frozen=True, eq=False)
class Ending:
    """How a recorded trial ended when it was repeated.

    Args:
        trial: as recorded.
        repeated: its outcome now.
        picture: what was seen at the end.
    """

    trial: Trial
    repeated: TrialOutcome
    picture: UInt8[np.ndarray, "h w 3"]

    @property
    def as_recorded(self) -> bool:
        """Whether it ended as before."""
        return self.repeated is self.trial.outcome


def photograph(
    factory: LaboratoryFactory,
    scenes: SceneTable,
    table: TrialTable,
    numbers: Sequence[int],
    camera: Camera,
    workers: int | None,
) -> list[Ending]:
    """Repeat trials and take a picture of the end of each.

    Args:
        factory: builds the laboratory in each worker.
        scenes, table: the recorded trials.
        numbers: which of them; in this order they come back, without those that the simulator fails at.
        camera: the bystander's.
        workers: number of processes; None takes every core.

    Raises:
        InputError: if the table lacks one of the trials.
    """
    recorded = {trial.trial_id: trial for trial in find_trials(table, numbers)}
    used = {trial.scene_id for trial in recorded.values()}
    needed = SceneTable(scenes.origin, tuple(s for s in scenes.scenes if s.scene_id in used))
    build = partial(_photographing, factory, needed, recorded, camera)
    jobs = do_jobs("Photographing", build, list(numbers), unit="trials", workers=workers)
    endings = {number: ending for number, ending in jobs if ending is not None}
    return [endings[number] for number in numbers if number in endings]


def write_sheets(
    endings: Sequence[Ending], output: str | Path, settings: FrameSheetSettings, quality: int
) -> list[str]:
    """Write a sheet of the lifted trials and one of the failed ones as WebP; returns where they lie.

    Args:
        endings: the pictures.
        output: folder of the sheets.
        settings: their layout.
        quality: of the compression, 0-100.
    """
    paths = []
    for name, lifted in (("lifted", True), ("failed", False)):
        own = [ending for ending in endings if (ending.trial.outcome is TrialOutcome.LIFTED) == lifted]
        if own:
            sheet = frame_sheet([it.trial for it in own], [it.picture for it in own], settings)
            path = Path(output) / f"last_frames_{name}.webp"
            with atomic_path(path) as temporary:
                sheet.save(temporary, format="WEBP", quality=quality, method=6)
            paths.append(str(path))
    return paths


def _photographing(
    factory: LaboratoryFactory, scenes: SceneTable, recorded: Mapping[int, Trial], camera: Camera
) -> Work[int, Ending]:
    laboratory = factory()

    def work(number: int, _begin: BeginStep) -> Ending:
        look = LastLook()
        repeated = repeat(laboratory, scenes, recorded[number], look)
        return Ending(recorded[number], repeated.outcome, look.picture(camera))

    return work
