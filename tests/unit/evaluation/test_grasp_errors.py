"""Errors of predicted grasps are distances and angles, however the angles are written."""

import math

import numpy as np
import pytest

from preshape.evaluation.grasp_errors import grasp_errors


def test_known_differences() -> None:
    lifted = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 14))
    predicted = lifted.copy()
    predicted[0, :3] += (0.3, 0.0, 0.4)
    predicted[1, 5] += 0.2  # yaw is the last turn, about a fixed axis
    predicted[1, 6:] += 0.1
    errors = grasp_errors(predicted, lifted)
    assert errors.n == 2
    assert (errors.palm_m.mean, errors.palm_m.smallest) == pytest.approx((0.25, 0.0))
    assert errors.orientation_rad.mean == pytest.approx(0.1)
    assert errors.joints_rad.median == pytest.approx(0.05)
    assert errors.to_dict()["palm_m"]["median"] == pytest.approx(0.25)


def test_the_same_rotation_written_otherwise_is_no_error() -> None:
    lifted, predicted = np.zeros((2, 14)), np.zeros((2, 14))
    lifted[0, 3], predicted[0, 3] = math.pi - 0.01, -math.pi + 0.01
    predicted[1, 3:6] = math.pi  # half a turn about every axis is none
    errors = grasp_errors(predicted, lifted)
    assert errors.orientation_rad.mean == pytest.approx(0.01)
    assert errors.orientation_rad.smallest == pytest.approx(0.0, abs=1e-6)


def test_no_grasps_have_no_errors() -> None:
    errors = grasp_errors(np.zeros((0, 14)), np.zeros((0, 14)))
    assert errors.n == 0
    assert math.isnan(errors.palm_m.mean)
