"""Theta against the palm pose and joints that it stands for."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace

SPACE = GraspSpace.palm_and_joints("test", {"index_0": (-0.4, 0.4), "thumb_0": (0.3, 1.3)})


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_theta_comes_back_as_the_palm_pose_that_it_was_made_from(
    roll: float, pitch: float, yaw: float
) -> None:
    pose = make_pose(Rotation.from_euler("xyz", (roll, pitch, yaw)).as_matrix(), np.array([0.1, -0.2, 0.9]))
    theta = SPACE.theta(pose, np.array([0.1, 0.5]))
    np.testing.assert_allclose(SPACE.palm_pose(theta), pose, atol=1e-9)
    np.testing.assert_array_equal(SPACE.joints(theta), [0.1, 0.5])


def test_the_palm_is_free_and_joints_have_limits() -> None:
    assert SPACE.dim == 8
    assert SPACE.joint_names == ("index_0", "thumb_0")
    assert np.isinf(SPACE.lower[:6]).all()
    np.testing.assert_array_equal(SPACE.upper[6:], [0.4, 1.3])


def test_narrowing_never_widens() -> None:
    narrow = SPACE.narrowed({"index_0": (-0.9, 0.1), "thumb_0": (1.3, 1.3)})
    np.testing.assert_array_equal(narrow.lower[6:], [-0.4, 1.3])
    np.testing.assert_array_equal(narrow.upper[6:], [0.1, 1.3])
    assert np.isinf(narrow.upper[:6]).all()
    np.testing.assert_array_equal(SPACE.lower[6:], [-0.4, 0.3])
