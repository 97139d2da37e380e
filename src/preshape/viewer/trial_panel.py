"""Chooses a trial of a table by object and outcome, and says what is known of it."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Int64
from viser import GuiApi, GuiButtonGroupHandle, GuiEvent

from preshape.data.trial import Trial
from preshape.data.trial_table import TrialTable
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.trial_choice import FirstTrial, TrialChoice
from preshape.viewer.trial_story import MEANING

ALL_OBJECTS, ALL_OUTCOMES = "all objects", "all outcomes"


class TrialPanel:
    """Dropdowns for object and outcome, and a slider through the trials that are left.

    Args:
        gui: the viewer's panel.
        jobs: does what the browser asks for.
        table: the trials.
        chosen: what is to be done when another trial is chosen.
    """

    def __init__(self, gui: GuiApi, jobs: JobQueue, table: TrialTable, chosen: Callable[[], None]) -> None:
        self._table, self._choice = table, TrialChoice(table)
        self._jobs, self._chosen = jobs, chosen
        self._rows: Int64[np.ndarray, "m"] = np.zeros(0, dtype=np.int64)
        self._shown: int | None = -1
        self._filtered: tuple[str | None, str | None] | None = None
        with gui.add_folder("Trials"):
            self.object = gui.add_dropdown("object", (ALL_OBJECTS, *self._choice.objects))
            self.outcome = gui.add_dropdown("outcome", (ALL_OUTCOMES, *self._choice.outcomes))
            self._count = gui.add_markdown("")
            self.number = gui.add_slider("trial", min=1, max=2, step=1, initial_value=1)
            steps = gui.add_button_group("", ("previous", "next"))
            self._about = gui.add_markdown("")
        self.object.on_update(lambda _: jobs.put(self._filter))
        self.outcome.on_update(lambda _: jobs.put(self._filter))
        self.number.on_update(lambda _: jobs.put(self._select))
        steps.on_click(self._step)

    @property
    def trial(self) -> Trial | None:
        """The chosen trial; None if there is none of this object and outcome."""
        if len(self._rows) == 0:
            return None
        chosen = np.arange(len(self._table)) == self._rows[self.number.value - 1]
        return self._table.where(chosen).to_trials()[0]

    @property
    def rows(self) -> Int64[np.ndarray, "m"]:
        """Rows of the trials that are of the object and ended in the chosen way."""
        return self._rows

    def choose(self, first: FirstTrial) -> None:
        """Choose as a user says on the command line; a trial goes before what it does not fit.

        Raises:
            InputError: if the table has no such object, outcome or trial.
        """
        rows = self._choice.rows(first.object_id, first.outcome)
        row = None if first.trial_id is None else self._choice.row_of(first.trial_id)
        if row is not None and row not in rows:
            first, rows = FirstTrial(), self._choice.rows()
        set_value(self.object, first.object_id or ALL_OBJECTS)
        set_value(self.outcome, first.outcome or ALL_OUTCOMES)
        self._take(rows, 0 if row is None else int(np.searchsorted(rows, row)))
        self._jobs.put(self._select)

    def describe(self, trial: Trial, success_prob: float) -> None:
        """Say what is known of a trial.

        Args:
            trial: the trial.
            success_prob: what the network says of its grasp; NaN for nothing.
        """
        lines = [
            f"### Trial {trial.trial_id}: {trial.outcome.value.upper()}",
            f"{trial.object_id}: {MEANING[trial.outcome]}.",
            f"- grasp: {trial.face.value.replace('_', ' ')}, by `{trial.planner}`",
        ]
        if np.isfinite(trial.lift_height_m):
            lines.append(f"- the object ended {100 * trial.lift_height_m:.1f} cm above its place")
        if np.isfinite(trial.success_prob):
            lines.append(f"- predicted when it was planned: p(success) = {trial.success_prob:.3f}")
        if np.isfinite(success_prob):
            lines.append(f"- the network says: p(success) = **{success_prob:.3f}**")
        if trial.outcome.executed and self._table.space.frame == "camera":
            off_mm = 1000 * float(np.linalg.norm(trial.reached[:3] - trial.planned[:3]))
            lines.append(f"- the palm reached its pose to within {off_mm:.1f} mm")
        self._about.content = "\n\n".join((*lines[:2], "\n".join(lines[2:])))

    def _step(self, event: GuiEvent[GuiButtonGroupHandle]) -> None:
        step = 1 if event.target.value == "next" else -1
        set_value(self.number, min(max(1, self.number.value + step), max(1, len(self._rows))))

    def _filter(self) -> None:
        """Browse other trials; what `choose` sets counts as chosen, too, and must not begin anew."""
        if self._names() != self._filtered:
            self._take(self._choice.rows(*self._names()), 0)
            self._select()

    def _names(self) -> tuple[str | None, str | None]:
        object_id = None if self.object.value == ALL_OBJECTS else self.object.value
        return object_id, None if self.outcome.value == ALL_OUTCOMES else self.outcome.value

    def _take(self, rows: Int64[np.ndarray, "m"], place: int) -> None:
        self._rows, self._filtered = rows, self._names()
        self._count.content = self._choice.count_in_words(rows)
        set_value(self.number, 1)
        self.number.max = max(2, len(rows))
        self.number.disabled = len(rows) < 2
        set_value(self.number, place + 1)

    def _select(self) -> None:
        """Tell of another trial; dragging the slider and filtering may ask for the same one again."""
        set_value(self.number, min(self.number.value, max(1, len(self._rows))))
        row = int(self._rows[self.number.value - 1]) if len(self._rows) else None
        if row != self._shown:
            self._shown = row
            self._about.content = ""
            self._chosen()
