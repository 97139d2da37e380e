"""Repeating recorded trials under variants of the laboratory, in worker processes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.data.trial import Trial
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.files import read_json, write_json
from sim.fingerprint import fingerprint
from sim.job_list import do_jobs
from sim.label_flips import LabelFlips, RepeatedTrial, compared, count_flips, from_row, to_row
from sim.laboratory import Laboratory
from sim.repetition import find_trials, repeat
from sim.variants import Variant
from sim.workers import BeginStep, Work


@dataclass(frozen=True)
class Repetition:
    """A job: repeat a trial in a variant of the laboratory."""

    variant: str
    trial_id: int


@dataclass(frozen=True, eq=False)
class VariantRun:
    """What is to be done for one variant.

    Args:
        variant: the laboratory.
        trial_ids: the trials to repeat.
        kept_at: where what came of it is kept; must belong to exactly this variant, table and code.
    """

    variant: Variant
    trial_ids: Sequence[int]
    kept_at: Path

    @classmethod
    def kept_in(
        cls, cache: Path, variant: Variant, trial_ids: Sequence[int], hashes: Sequence[str]
    ) -> "VariantRun":
        """A run whose result is kept in the folder of derived files.

        Args:
            cache: the folder.
            variant, trial_ids: what is to be done.
            hashes: of the table and of the objects.
        """
        parts = (variant.laboratory, list(trial_ids), *hashes)
        name = fingerprint(*parts, cache=str(cache))
        return cls(variant, trial_ids, cache / "sensitivity" / f"{name}.json")


def run_variants(
    runs: Sequence[VariantRun], scenes: SceneTable, table: TrialTable, workers: int | None
) -> dict[str, LabelFlips]:
    """Repeat all trials that are not repeated yet, and count flips per variant.

    A variant is kept as soon as all its trials are repeated; a second start goes on after those.

    Args:
        runs: the variants with their trials.
        scenes, table: the recorded trials.
        workers: number of processes; None takes every core.

    Raises:
        InputError: if the table lacks one of the trials, or a result cannot be kept.
    """
    open_runs = {run.variant.name: run for run in runs if not run.kept_at.exists()}
    numbers = sorted({number for run in open_runs.values() for number in run.trial_ids})
    recorded = {trial.trial_id: trial for trial in find_trials(table, numbers)}
    jobs = [Repetition(name, number) for name, run in open_runs.items() for number in run.trial_ids]
    if jobs:
        used = {trial.scene_id for trial in recorded.values()}
        needed = SceneTable(scenes.origin, tuple(s for s in scenes.scenes if s.scene_id in used))
        laboratories = {name: run.variant.laboratory for name, run in open_runs.items()}
        build = partial(_repeating, laboratories, needed, recorded)
        done: dict[str, dict[int, RepeatedTrial]] = {name: {} for name in open_runs}
        for job, trial in do_jobs("Repeating", build, jobs, unit="trials", workers=workers):
            own, run = done[job.variant], open_runs[job.variant]
            own[job.trial_id] = compared(recorded[job.trial_id], trial)
            if len(own) == len(run.trial_ids):
                write_json(run.kept_at, {"trials": [to_row(own[number]) for number in run.trial_ids]})
    return {run.variant.name: _flips(run) for run in runs}


def _flips(run: VariantRun) -> LabelFlips:
    trials = [from_row(row) for row in read_json(run.kept_at)["trials"]]
    return count_flips(run.variant.overrides, trials)


def _repeating(
    laboratories: Mapping[str, DictConfig], scenes: SceneTable, recorded: Mapping[int, Trial]
) -> Work[Repetition, Trial]:
    @lru_cache(maxsize=1)  # jobs come variant by variant
    def build(name: str) -> Laboratory:
        laboratory: Laboratory = instantiate(laboratories[name])
        return laboratory

    def work(job: Repetition, _begin: BeginStep) -> Trial:
        return repeat(build(job.variant), scenes, recorded[job.trial_id])

    return work
