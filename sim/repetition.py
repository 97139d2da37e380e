"""Repeating trials of a table."""

from collections.abc import Iterable

from preshape.data.trial import Trial
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from sim.execution import Spectator
from sim.laboratory import Laboratory
from sim.trial import PlannedGrasp


def find_trials(table: TrialTable, numbers: Iterable[int]) -> list[Trial]:
    """The trials with the given numbers, in their order.

    Raises:
        InputError: if the table has no trial of a number.
    """
    trials = {trial.trial_id: trial for trial in table.to_trials()}
    wanted = list(numbers)
    unknown = [number for number in wanted if number not in trials]
    if unknown:
        raise InputError(
            f"The table has no trial {unknown[0]}",
            where="trials",
            fix=f"choose numbers between {min(trials)} and {max(trials)} from its column trial_id",
        )
    return [trials[number] for number in wanted]


def repeat(
    laboratory: Laboratory, scenes: SceneTable, trial: Trial, spectator: Spectator | None = None
) -> Trial:
    """Try a recorded grasp again, on its own scene and with its own seed."""
    return laboratory.runner.run(scenes.by_id[trial.scene_id], recorded_grasp(trial), spectator)


def recorded_grasp(trial: Trial) -> PlannedGrasp:
    """The grasp that a trial tried."""
    return PlannedGrasp(
        trial_id=trial.trial_id,
        planner=trial.planner,
        face=trial.face,
        initial=trial.initial,
        planned=trial.planned,
        success_prob=trial.success_prob,
        seed=trial.seed,
    )
