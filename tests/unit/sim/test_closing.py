"""The closing controller moves the joints that the paper names and lets each finger stop by itself."""

import numpy as np
import pytest

from preshape.data.trial import GraspType
from sim.closing import ClosingController, ClosingSettings, GripperClosing

FINGERS = {"index": (0, 1, 2, 3), "middle": (4, 5, 6, 7), "ring": (8, 9, 10, 11), "thumb": (12, 13, 14, 15)}
PERIOD_S = 1 / 60
SETTINGS = ClosingSettings()


def controller(grasp_type: GraspType) -> ClosingController:
    return ClosingController(FINGERS, grasp_type, np.zeros(16), np.full(16, 1.6), SETTINGS)


@pytest.mark.parametrize(
    ("grasp_type", "closing"),
    [(GraspType.SIDE, {1, 2, 3, 5, 6, 7, 9, 10, 11, 14, 15}), (GraspType.OVERHEAD, {1, 5, 9, 14})],
)
def test_only_the_joints_of_the_rule_close(grasp_type: GraspType, closing: set[int]) -> None:
    hand = controller(grasp_type)
    targets = hand.update(np.zeros(16), PERIOD_S)
    assert set(np.flatnonzero(targets)) == closing


def test_free_fingers_close_at_constant_speed_up_to_their_limits() -> None:
    hand = controller(GraspType.SIDE)
    positions, before = np.zeros(16), np.zeros(16)
    while not hand.done:
        speeds = (positions - before) / PERIOD_S
        before, positions = positions, hand.update(positions, PERIOD_S).copy()
        assert np.all(speeds <= SETTINGS.thumb_speed_rad_s + 1e-9)
    assert hand.elapsed_s == pytest.approx(1.6 / SETTINGS.finger_speed_rad_s, abs=0.5)
    assert np.all(positions <= 1.6)


def test_a_blocked_finger_stops_and_the_others_go_on() -> None:
    hand = controller(GraspType.SIDE)
    positions = np.zeros(16)
    for _ in range(60):
        positions = hand.update(positions, PERIOD_S).copy()
        positions[[1, 2, 3]] = np.minimum(positions[[1, 2, 3]], 0.1)
    assert np.all(hand.targets[[1, 2, 3]] <= 0.1 + SETTINGS.lead_rad + 1e-12)
    assert hand.targets[5] > hand.targets[1]
    assert not hand.done


def test_a_finger_that_trembles_in_one_place_has_stopped() -> None:
    hand = controller(GraspType.SIDE)
    tremble = SETTINGS.stopped_travel_rad / 3
    for k in range(round(SETTINGS.stopped_time_s / PERIOD_S) + 2):
        hand.update(np.full(16, tremble * (-1) ** k), PERIOD_S)
    assert hand.done


def test_a_finger_that_never_stops_does_not_hold_the_trial_up() -> None:
    hand = controller(GraspType.SIDE)
    positions = np.zeros(16)
    while not hand.done:
        positions = positions + 1.2 * PERIOD_S
        hand.update(positions, PERIOD_S)
    assert hand.elapsed_s == pytest.approx(SETTINGS.max_time_s, abs=2 * PERIOD_S)


def test_a_gripper_closes_both_fingers_until_they_stop() -> None:
    settings = GripperClosing()
    hand = ClosingController(
        {"left": (0,), "right": (1,)}, GraspType.OVERHEAD, np.zeros(2), np.full(2, 0.02), settings
    )
    positions = np.zeros(2)
    while not hand.done:
        targets = hand.update(positions, PERIOD_S)
        assert np.all(targets - positions <= settings.lead_m + 1e-12)
        positions = np.minimum(targets, (0.012, 0.02))  # the left finger meets something
    assert np.all(positions == (0.012, 0.02))
    assert hand.elapsed_s < settings.max_time_s
