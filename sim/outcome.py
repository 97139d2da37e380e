"""From what the simulator measured to the label of a trial."""

from dataclasses import dataclass

import numpy as np

from preshape.data.trial import TrialOutcome


@dataclass(frozen=True)
class OutcomeSettings:
    """What counts as lifted.

    Args:
        lifted_height_m: least height of the centre of mass over its resting height at the end.
        rose_height_m: an object that rose higher than this and was lost is DROPPED, not MISSED.
        carried_speed_m_s: greatest speed of the object relative to the palm at the end.
        thrown_height_m: an object that was ever this much higher than the palm's own rise was thrown.
    """

    lifted_height_m: float = 0.13
    rose_height_m: float = 0.03
    carried_speed_m_s: float = 0.05
    thrown_height_m: float = 0.05


@dataclass(frozen=True)
class Measurements:
    """What the simulator measured while and after the hand lifted.

    Args:
        final_height_m, highest_m: rise of the object's centre of mass over its resting height: at the end, at
            most.
        palm_rise_m: how far the palm was lifted.
        relative_speed_m_s: speed of the object relative to the palm at the end.
        touches_hand, touches_support: contacts of the object at the end; support is the table or the floor.
    """

    final_height_m: float
    highest_m: float
    palm_rise_m: float
    relative_speed_m_s: float
    touches_hand: bool
    touches_support: bool


def judge(measured: Measurements, settings: OutcomeSettings) -> TrialOutcome:
    """The outcome of an executed trial; UNSTABLE if a measurement is not a number."""
    numbers = (measured.final_height_m, measured.highest_m, measured.relative_speed_m_s)
    if not np.all(np.isfinite(numbers)):
        return TrialOutcome.UNSTABLE
    held = measured.touches_hand and not measured.touches_support
    carried = measured.relative_speed_m_s <= settings.carried_speed_m_s
    thrown = measured.highest_m > measured.palm_rise_m + settings.thrown_height_m
    if measured.final_height_m >= settings.lifted_height_m and held and carried and not thrown:
        return TrialOutcome.LIFTED
    if measured.highest_m >= settings.rose_height_m:
        return TrialOutcome.DROPPED
    return TrialOutcome.MISSED
