"""The hand's forward kinematics agrees with Pinocchio and is differentiable."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from preshape.errors import InputError
from preshape.geometry.pose import make_pose, rotation_from_euler_xyz
from preshape.hands.allegro import PALM_LINK, PRESHAPE_JOINTS, TIP_LINKS, allegro_hand, allegro_urdf
from preshape.hands.kinematics import HandKinematics

HAND = allegro_hand()
MODEL = pin.buildModelFromUrdf(str(allegro_urdf()))


def random_theta(seed: int, count: int = 3) -> Tensor:
    generator = torch.Generator().manual_seed(seed)
    scale = torch.tensor([1.0] * 3 + [3.0, 1.5, 3.0] + [1.2] * 8, dtype=torch.float64)
    return (torch.rand((count, 14), generator=generator, dtype=torch.float64) * 2 - 1) * scale


def frames_by_pinocchio(theta: np.ndarray) -> dict[str, np.ndarray]:
    """Poses in the camera frame of all links of the hand, the palm link being at theta's palm pose."""
    q = pin.neutral(MODEL)
    for name, angle in zip(PRESHAPE_JOINTS, theta[6:], strict=True):
        q[MODEL.joints[MODEL.getJointId(name)].idx_q] = angle
    data = MODEL.createData()
    pin.framesForwardKinematics(MODEL, data, q)
    palm = make_pose(rotation_from_euler_xyz(torch.tensor(theta[3:6])).numpy(), theta[:3])
    return {frame.name: palm @ data.oMf[i].homogeneous for i, frame in enumerate(MODEL.frames)}


@given(st.integers(0, 2**31))
@settings(deadline=None, max_examples=25)
def test_links_are_where_pinocchio_has_them(seed: int) -> None:
    theta = random_theta(seed)
    poses, tips = HAND.link_poses(theta).numpy(), HAND.fingertips(theta).numpy()
    for row, numbers in enumerate(theta.numpy()):
        frames = frames_by_pinocchio(numbers)
        for finger, tip in enumerate(TIP_LINKS):
            first = 4 * finger
            links = [f"link_{first + k}.0" for k in range(4)] + [tip]
            for k, link in enumerate(links):
                np.testing.assert_allclose(poses[row, finger, k], frames[link], atol=1e-9)
            np.testing.assert_allclose(tips[row, finger], frames[tip][:3, 3], atol=1e-9)


def test_gradient_is_right() -> None:
    theta = random_theta(0, count=1).requires_grad_()
    assert torch.autograd.gradcheck(HAND.link_poses, theta)
    assert torch.autograd.gradcheck(HAND.palm_corners, theta)


def test_every_parameter_turns_or_moves_a_fingertip() -> None:
    theta = random_theta(1, count=1)
    jacobian = torch.autograd.functional.jacobian(HAND.link_poses, theta)[0, :, -1, :3, :, 0]
    assert (jacobian.abs().amax(dim=(0, 1, 2)) > 0.1).all()


def test_single_precision_stays_single() -> None:
    theta = random_theta(2)
    single = HAND.fingertips(theta.float())
    assert single.dtype == torch.float32
    torch.testing.assert_close(single.double(), HAND.fingertips(theta), atol=1e-5, rtol=0)


def test_palm_offset_moves_the_hand_against_it() -> None:
    theta, offset = random_theta(3), (0.01, 0.02, -0.05)
    moved = allegro_hand(palm_offset_m=offset)
    origin_of_palm = moved.palm_link_pose(theta)
    palm = (origin_of_palm[:, :3, :3] @ torch.tensor(offset, dtype=torch.float64)) + origin_of_palm[:, :3, 3]
    torch.testing.assert_close(palm, theta[:, :3])
    shift = HAND.fingertips(theta) - moved.fingertips(theta)
    torch.testing.assert_close(shift, (palm - origin_of_palm[:, :3, 3])[:, None].expand_as(shift))


def test_palm_frame_is_the_one_of_theta() -> None:
    """At zero the fingers reach along z, the index is at +y, and the closing side is at +x."""
    theta = torch.zeros((1, 14), dtype=torch.float64)
    tips, corners = HAND.fingertips(theta)[0], HAND.palm_corners(theta)[0]
    assert (tips[:3, 2] > 0.12).all()
    assert tips[0, 1] > tips[1, 1] > tips[2, 1]
    assert corners[4:, 0].min() > corners[:4, 0].max()
    bent = theta.clone()
    bent[0, 7] = 0.5  # index finger's joint 1 closes towards the object
    assert HAND.fingertips(bent)[0, 0, 0] > tips[0, 0] + 0.05


def test_no_weights_are_saved_for_the_hand() -> None:
    assert not HAND.state_dict()
    assert not list(HAND.parameters())


@pytest.mark.parametrize(
    ("tips", "joints", "message"),
    [
        (("link_3.0_tip", "nowhere"), (), "no chain"),
        (TIP_LINKS, ("joint_99.0",), "joint_99.0"),
        (("link_3.0_tip", "link_7.0"), (), "differ"),
    ],
)
def test_what_the_urdf_lacks_is_refused(tips: tuple[str, ...], joints: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        HandKinematics.from_urdf(allegro_urdf(), palm_link=PALM_LINK, tip_links=tips, preshape_joints=joints)


@pytest.mark.parametrize("content", [None, b"", b"<robot><joint", b"<robot/>"])
def test_unreadable_urdf_is_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "hand.urdf"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError):
        HandKinematics.from_urdf(path, palm_link="a", tip_links=("b",), preshape_joints=())
