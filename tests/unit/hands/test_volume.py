"""The spheres of the hand sit on its links, and fill their shapes."""

import numpy as np
import torch

from preshape.geometry.pose import rotation_from_euler_xyz
from preshape.hands.allegro import PALM_LINK, TIP_LINKS, allegro_hand, allegro_urdf, allegro_volume
from preshape.hands.urdf_chain import Urdf
from preshape.hands.volume import HandVolume

OFFSET = (0.01, -0.02, 0.03)


def some_theta(count: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (count, 14))


def test_spheres_move_with_their_links() -> None:
    """Each finger's last sphere is its tip."""
    theta, volume = some_theta(4), allegro_volume(OFFSET)
    rotation = rotation_from_euler_xyz(torch.from_numpy(theta[:, 3:6])).numpy()
    centres = volume.in_palm(theta) @ rotation.swapaxes(1, 2) + theta[:, None, :3]
    tips = allegro_hand(OFFSET).fingertips(torch.from_numpy(theta)).numpy()
    nearest = np.linalg.norm(centres[:, :, None] - tips[:, None], axis=-1).argmin(axis=1)
    assert (nearest == nearest[0]).all()
    found = np.take_along_axis(centres, nearest[..., None], axis=1)
    np.testing.assert_allclose(found, tips, atol=1e-9)
    np.testing.assert_allclose(volume.radii[nearest[0]], 0.012)


def test_spheres_fill_the_collision_shapes_from_within() -> None:
    urdf, volume = Urdf(allegro_urdf()), allegro_volume()
    palm = urdf.collision_box(PALM_LINK)
    own = volume.in_palm(np.zeros((1, 14)))[0]
    count = np.argmax(volume.radii < palm.extents.min() / 2 - 1e-9)
    local = own[:count] - palm.T_link_box[:3, 3]
    reach = np.abs(local) + volume.radii[:count, None]
    np.testing.assert_allclose(reach.max(axis=0), palm.extents / 2)
    assert sum(len(urdf.links(PALM_LINK, tip)) for tip in TIP_LINKS) == 20
    assert isinstance(volume, HandVolume)


def test_joint_gradient_agrees_with_finite_differences() -> None:
    theta, volume = some_theta(2), allegro_volume()
    weights = np.random.default_rng(1).normal(size=volume.in_palm(theta).shape)
    gradient = volume.joint_gradient(theta, weights)
    for parameter in range(14):
        offset = np.zeros(14)
        offset[parameter] = 1e-6
        difference = (volume.in_palm(theta + offset) - volume.in_palm(theta - offset)) / 2e-6
        expected = (difference * weights).sum(axis=(1, 2))
        np.testing.assert_allclose(gradient[:, parameter], expected, atol=1e-7)
