import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.grasps.space import GraspSpace
from preshape.planning.bounds import Bounds, BoxSize

SPACE = GraspSpace.palm_and_joints("test", {"index_0": (-0.3, 0.28), "thumb_0": (1.396, 1.396)})


def test_box_is_the_papers_cube_and_angles_within_the_joint_limits() -> None:
    initial = np.array([[0.1, 0.2, 0.7, 3.1, -0.2, 0.0, 0.1, 1.396]])
    bounds = Bounds.around(initial, SPACE, BoxSize())
    np.testing.assert_allclose(bounds.half_width[0], [0.05] * 3 + [0.157] * 3 + [0.29, 0.0])
    np.testing.assert_array_equal(bounds.lower[0, 6:], [-0.3, 1.396])
    np.testing.assert_array_equal(bounds.fixed[0], [False] * 7 + [True])


@given(st.lists(st.floats(-1e6, 1e6), min_size=8, max_size=8))
def test_projection_is_inside_to_the_bit_and_moves_nothing_that_is_inside(theta: list[float]) -> None:
    bounds = Bounds.around(np.zeros((1, 8)), SPACE, BoxSize(position_m=0.1, rotation_rad=0.3))
    projected = bounds.project(np.array([theta]))
    assert ((projected >= bounds.lower) & (projected <= bounds.upper)).all()
    assert (bounds.project(projected) == projected).all()


def test_a_box_that_is_empty_is_refused() -> None:
    with pytest.raises(ValueError, match="lower limit"):
        Bounds(np.ones((1, 2)), np.zeros((1, 2)))


def test_only_directions_out_of_the_box_are_blocked() -> None:
    bounds = Bounds(np.zeros((1, 4)), np.ones((1, 4)))
    theta = np.array([[0.0, 0.0, 1.0, 0.5]])
    direction = np.array([[-1.0, 1.0, 1.0, 1.0]])
    assert bounds.blocks(theta, direction).tolist() == [[True, False, True, False]]
