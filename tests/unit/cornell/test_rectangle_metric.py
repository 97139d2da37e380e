"""The rectangle metric on cases that are computed by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_metric import angle_between, is_correct, jaccard

BASE = GraspRectangle(100.0, 100.0, 0.0, 40.0, 20.0)
rectangles = st.builds(
    GraspRectangle, st.floats(0, 60), st.floats(0, 60), st.floats(0, 4), st.floats(1, 60), st.floats(1, 60)
)


def turned(degrees: float, u: float = 100, opening: float = 40, jaw: float = 20) -> GraspRectangle:
    return GraspRectangle(float(u), 100.0, math.radians(degrees), float(opening), float(jaw))


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        (BASE, 1.0),
        (turned(180), 1.0),
        (turned(0, u=120), 1 / 3),  # half of each is shared: 400 of 1200
        (turned(0, u=140), 0.0),  # they touch
        (turned(0, u=500), 0.0),
        (turned(0, opening=20, jaw=10), 0.25),  # one within the other
        (turned(90), 1 / 3),  # a cross shares the 20 x 20 in its middle
        (turned(90, opening=20, jaw=40), 1.0),
        (turned(0, opening=0), 0.0),
    ],
)
def test_overlaps_computed_by_hand(other: GraspRectangle, expected: float) -> None:
    assert jaccard(BASE, other) == pytest.approx(expected)
    assert jaccard(other, BASE) == pytest.approx(expected)


def test_a_square_turned_by_45_degrees_makes_an_octagon() -> None:
    square = GraspRectangle(0.0, 0.0, 0.0, 2.0, 2.0)
    shared = 8 * (math.sqrt(2) - 1)
    expected = shared / (8 - shared)
    assert jaccard(square, GraspRectangle(0.0, 0.0, math.pi / 4, 2.0, 2.0)) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("one", "other", "degrees"),
    [(0, 29, 29), (1, 179, 2), (179, 1, 2), (-10, 10, 20), (0, 90, 90), (5, 185, 0)],
)
def test_angles_wrap_at_half_a_turn(one: float, other: float, degrees: float) -> None:
    assert angle_between(turned(one), turned(other)) == pytest.approx(math.radians(degrees), abs=1e-9)


@pytest.mark.parametrize(
    ("predicted", "correct"),
    [
        (BASE, True),
        (turned(29), True),
        (turned(31), False),
        (turned(-29), True),
        (turned(-31), False),
        (turned(151), True),
        (turned(149), False),
        (turned(0, u=123.9), True),  # 322 of 1278 shared
        (turned(0, u=124.1), False),  # 318 of 1282
    ],
)
def test_right_is_an_overlap_above_a_quarter_within_30_degrees(
    predicted: GraspRectangle, correct: bool
) -> None:
    assert is_correct(predicted, [BASE]) is correct


def test_any_positive_rectangle_will_do_but_it_must_do_alone() -> None:
    far, crossed = turned(0, u=500), turned(90)
    assert is_correct(BASE, [far, BASE])
    # the one has the angle, the other the overlap
    assert not is_correct(BASE, [far, crossed])
    assert not is_correct(BASE, [])


@given(rectangles, rectangles)
def test_the_overlap_is_symmetric_and_a_share(one: GraspRectangle, other: GraspRectangle) -> None:
    overlap = jaccard(one, other)
    assert -1e-9 <= overlap <= 1 + 1e-9
    assert overlap == pytest.approx(jaccard(other, one), abs=1e-6)
    assert jaccard(one, one) == pytest.approx(1)
