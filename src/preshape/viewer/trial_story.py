"""What happened in a trial, in words."""

import numpy as np

from preshape.data.trial import TrialOutcome
from preshape.viewer.recording import TrialRecording

MEANING = {
    TrialOutcome.LIFTED: "held up at the end",
    TrialOutcome.DROPPED: "rose with the hand and was lost",
    TrialOutcome.MISSED: "the hand closed and rose without it",
    TrialOutcome.UNREACHABLE: "no arm configuration reaches the palm pose; never executed",
    TrialOutcome.BLOCKED: "arm configurations exist, but all collide; never executed",
    TrialOutcome.UNSTABLE: "the simulation diverged, or the object did not come to rest",
}
SEEN_M = 0.003
"""A shorter way is not worth a word."""


def trial_story(recording: TrialRecording) -> str:
    """How the trial ended and what led to it, as Markdown: one point for each part of the trial."""
    points = [_approach(recording), _closing(recording), _lift(recording)]
    lines = "\n".join(f"- {point}" for point in points if point)
    outcome = recording.outcome
    return f"**{outcome.value.upper()}**: {MEANING[outcome]}\n\n{lines}"


def instant_in_words(recording: TrialRecording, instant: int) -> str:
    """Phase, time, height and contacts at one instant."""
    _, parts = recording.contacts_at(instant)
    touched = f"touched by {', '.join(parts)}" if parts else "not touched"
    rise_cm = 100 * recording.object_rise_m[instant]
    return f"{recording.phases[instant]}, {recording.times_s[instant]:.2f} s: {rise_cm:.1f} cm up, {touched}"


def _approach(recording: TrialRecording) -> str:
    end = _last(recording, "approach")
    pushed_cm = 100 * _moved_m(recording, 0, end)
    if pushed_cm < 100 * SEEN_M:
        return "approach: the object stays where it is"
    return f"approach: the hand pushes the object {pushed_cm:.1f} cm away before it closes"


def _closing(recording: TrialRecording) -> str:
    begin, end = _last(recording, "approach"), _last(recording, "close")
    _, parts = recording.contacts_at(end)
    moved_cm = 100 * _moved_m(recording, begin, end)
    shifted = f", which moves it {moved_cm:.1f} cm" if moved_cm >= 100 * SEEN_M else ""
    if not parts:
        return f"closing: ends without touching the object{shifted}"
    return f"closing: ends with {', '.join(parts)} on the object{shifted}"


def _lift(recording: TrialRecording) -> str:
    closed = _last(recording, "close")
    risen_cm = 100 * float(recording.object_rise_m[closed:].max())
    touching = np.unique(recording.contact_instants)
    after = touching[touching > closed]
    last = len(recording) - 1
    if len(after) == 0:
        return f"lift: the hand does not touch the object again; it rises {risen_cm:.1f} cm"
    if after[-1] == last:
        _, parts = recording.contacts_at(last)
        palm_cm, end_cm = 100 * recording.palm_rise_m[last], 100 * recording.object_rise_m[last]
        return (
            f"lift: the palm rises {palm_cm:.1f} cm, the object {risen_cm:.1f} cm at most; it ends "
            f"{end_cm:.1f} cm up, touched by {', '.join(parts)}"
        )
    lost_s, phase = recording.times_s[after[-1]], recording.phases[after[-1]]
    return f"lift: the object rises {risen_cm:.1f} cm at most and slips away at {lost_s:.1f} s ({phase})"


def _last(recording: TrialRecording, phase: str) -> int:
    """The last instant of a phase, or of the recording where there is none."""
    instants = [k for k, name in enumerate(recording.phases) if name == phase]
    return instants[-1] if instants else len(recording) - 1


def _moved_m(recording: TrialRecording, begin: int, end: int) -> float:
    where = recording.T_world_object[:, :3, 3]
    return float(np.linalg.norm(where[end] - where[begin]))
