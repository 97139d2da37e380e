"""Labels follow from measurements as the trial's docstring says."""

from dataclasses import replace

import pytest

from preshape.data.trial import TrialOutcome
from sim.outcome import Measurements, OutcomeSettings, judge

HELD = Measurements(
    final_height_m=0.15,
    highest_m=0.151,
    palm_rise_m=0.15,
    relative_speed_m_s=0.001,
    touches_hand=True,
    touches_support=False,
)


def outcome(**changes: float | bool) -> TrialOutcome:
    return judge(replace(HELD, **changes), OutcomeSettings())


def test_an_object_that_hangs_in_the_hand_is_lifted() -> None:
    assert outcome() is TrialOutcome.LIFTED


@pytest.mark.parametrize(
    "change",
    [
        {"final_height_m": 0.129},
        {"touches_hand": False},
        {"touches_support": True},
        {"relative_speed_m_s": 0.2},
        {"highest_m": 0.3},
    ],
    ids=["too low", "not held", "leans on the table", "still falling", "thrown"],
)
def test_one_missing_condition_is_enough_to_not_be_lifted(change: dict[str, float | bool]) -> None:
    assert outcome(**change) is TrialOutcome.DROPPED


def test_an_object_that_never_rose_is_missed() -> None:
    assert outcome(final_height_m=0.0, highest_m=0.01, touches_support=True) is TrialOutcome.MISSED


@pytest.mark.parametrize("field", ["final_height_m", "highest_m", "relative_speed_m_s"])
def test_a_simulation_that_diverged_has_no_label(field: str) -> None:
    assert outcome(**{field: float("nan")}) is TrialOutcome.UNSTABLE
    assert not TrialOutcome.UNSTABLE.executed
