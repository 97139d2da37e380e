"""Rectangles and their vertices are the same thing, in either order, at every angle, and in a mirror."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.cornell.rectangle import GraspRectangle, misfit_px

CORNERS = np.array([[300.0, 250], [340, 250], [340, 270], [300, 270]])
lengths = st.floats(1, 200)
rectangles = st.builds(
    GraspRectangle, st.floats(0, 639), st.floats(0, 479), st.floats(-10, 10), lengths, lengths
)


def assert_same(one: GraspRectangle, other: GraspRectangle) -> None:
    turned = abs(one.angle_rad - other.angle_rad)
    assert min(turned, math.pi - turned) == pytest.approx(0, abs=1e-6)
    for name in ("u", "v", "opening_px", "jaw_px"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-6)


def test_the_first_edge_is_the_opening() -> None:
    assert GraspRectangle.from_corners(CORNERS) == GraspRectangle(320.0, 260.0, 0.0, 40.0, 20.0)


@pytest.mark.parametrize("order", [[1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]], ids=str)
def test_the_vertices_may_run_either_way_round(order: list[int]) -> None:
    assert_same(GraspRectangle.from_corners(CORNERS[order]), GraspRectangle.from_corners(CORNERS))


def test_starting_on_a_jaw_is_another_grasp() -> None:
    other = GraspRectangle.from_corners(np.roll(CORNERS, 1, axis=0))
    assert (other.opening_px, other.jaw_px, other.angle_rad) == (20, 40, pytest.approx(math.pi / 2))


@given(rectangles)
def test_vertices_make_the_rectangle_again(rectangle: GraspRectangle) -> None:
    assert 0 <= rectangle.angle_rad < math.pi
    assert misfit_px(rectangle.corners()) < 1e-9
    assert_same(GraspRectangle.from_corners(rectangle.corners()), rectangle)
    assert_same(GraspRectangle.from_corners(rectangle.corners()[::-1]), rectangle)


@pytest.mark.parametrize("angle", [0.0, math.pi, -math.pi, 2 * math.pi, -1e-20], ids=str)
def test_half_a_turn_is_no_turn(angle: float) -> None:
    assert GraspRectangle(0.0, 0.0, angle, 2.0, 1.0).angle_rad == 0


@given(rectangles)
def test_a_mirrored_rectangle_has_mirrored_vertices(rectangle: GraspRectangle) -> None:
    mirrored = rectangle.corners() * (-1, 1) + (639, 0)
    assert_same(rectangle.mirrored(640), GraspRectangle.from_corners(mirrored))
    assert_same(rectangle.mirrored(640).mirrored(640), rectangle)


def test_pixels_of_a_mirrored_image_move_with_the_rectangle() -> None:
    image = np.zeros((480, 640))
    image[260, 300] = 1
    mirrored = GraspRectangle(300.0, 260.0, 0.3, 40.0, 20.0).mirrored(640)
    assert image[:, ::-1][int(mirrored.v), int(mirrored.u)] == 1
    assert mirrored.angle_rad == pytest.approx(math.pi - 0.3)


def test_misfit_is_the_distance_from_a_rectangle() -> None:
    assert misfit_px(CORNERS) == 0
    # one vertex 8 px off: the nearest parallelogram has each 2 px off, and is skewed by 2 px
    moved = CORNERS + np.array([[0, 0], [0, 0], [8, 0], [0, 0]])
    assert misfit_px(moved) == pytest.approx(4, abs=0.1)
    assert misfit_px(np.zeros((4, 2))) == math.inf
