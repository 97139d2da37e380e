"""A recorded trial, with a slider along its time."""

import time
from collections.abc import Callable

import numpy as np
from viser import GuiApi

from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.line_plot import Line, LinePlot
from preshape.viewer.recording import TrialRecording
from preshape.viewer.trial_story import instant_in_words, trial_story

NOTHING = "Nothing has been executed here yet."


class ReplayPanel:
    """Chooses an instant of a recording, and plays it.

    Args:
        gui: the viewer's panel.
        jobs: does what the browser asks for.
        moved: what is to be done when another instant is chosen.
    """

    def __init__(self, gui: GuiApi, jobs: JobQueue, moved: Callable[[], None]) -> None:
        self.recording: TrialRecording | None = None
        self._moved = moved
        self._began_s, self._due = 0.0, 0
        self._text = gui.add_markdown(NOTHING)
        self.playing = gui.add_checkbox("play", False, disabled=True)
        self.instant = gui.add_slider("instant", min=0, max=1, step=1, initial_value=0, disabled=True)
        self._now = gui.add_markdown("")
        lines = [Line("object (cm)", "#005ab5"), Line("palm (cm)", "#e69f00", (6.0, 4.0))]
        self.plot = LinePlot(gui, "time (s)", lines)
        self.playing.on_update(lambda _: jobs.put(self._begin))
        self.instant.on_update(lambda _: jobs.put(self._show_instant))

    def show(self, recording: TrialRecording, of_what: str) -> None:
        """Show a recording from its beginning.

        Args:
            recording: the states.
            of_what: which grasp it is of, for the reader.
        """
        self.recording = recording
        self._text.content = f"**{of_what.capitalize()}**\n\n{trial_story(recording)}"
        rises_cm = 100 * np.stack((recording.object_rise_m, recording.palm_rise_m))
        set_value(self.playing, False)
        set_value(self.instant, 0)
        self.instant.max = max(1, len(recording) - 1)
        self.instant.disabled = self.playing.disabled = len(recording) < 2
        self.plot.show(recording.times_s, rises_cm)
        self._show_instant()

    def clear(self, why: str = NOTHING) -> None:
        """Show nothing, and say why."""
        self.recording = None
        set_value(self.playing, False)
        self.instant.disabled = self.playing.disabled = True
        self._text.content, self._now.content = why, ""
        self.plot.show(np.zeros(1), np.full((2, 1), np.nan))
        self._moved()

    def tick(self) -> None:
        """While playing, go to the instant that is due."""
        if self.recording is None or not self.playing.value:
            return
        due = int(np.searchsorted(self.recording.times_s, time.monotonic() - self._began_s))
        self._due = min(due, len(self.recording) - 1)
        set_value(self.instant, self._due)
        if due >= len(self.recording):
            set_value(self.playing, False)

    def _begin(self) -> None:
        if self.recording is None or not self.playing.value:
            return
        if self.instant.value == len(self.recording) - 1:
            set_value(self.instant, 0)
        self._began_s = time.monotonic() - float(self.recording.times_s[self.instant.value])

    def _show_instant(self) -> None:
        if self.instant.value != self._due:  # the user moved the slider: play on from there
            self._begin()
        if self.recording is not None:
            self.plot.mark(self.instant.value)
            self._now.content = instant_in_words(self.recording, self.instant.value)
            self._moved()
