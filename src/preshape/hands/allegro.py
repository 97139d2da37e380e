"""The right Allegro hand of the package `example-robot-data`."""

from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from preshape.errors import InputError
from preshape.hands.kinematics import HandKinematics
from preshape.hands.volume import HandVolume

PALM_LINK = "palm_link"
TIP_LINKS = ("link_3.0_tip", "link_7.0_tip", "link_11.0_tip", "link_15.0_tip")
"""Tips of index, middle, ring finger and thumb."""
PRESHAPE_JOINTS = tuple(f"joint_{first + k}.0" for first in (0, 4, 8, 12) for k in (0, 1))
"""Joints 0 and 1 of each finger, in the order of theta."""


def allegro_hand(palm_offset_m: Sequence[float] = (0.0, 0.0, 0.0)) -> HandKinematics:
    """Kinematics of the right Allegro hand for theta of 14 numbers.

    The palm link has x out of the palm, y towards the index finger and z along the fingers, its origin at the
    root of the middle finger.

    Args:
        palm_offset_m: origin of theta's palm frame in the palm link.

    Raises:
        InputError: the hand's model is not installed.
    """
    return HandKinematics.from_urdf(
        allegro_urdf(),
        palm_link=PALM_LINK,
        tip_links=TIP_LINKS,
        preshape_joints=PRESHAPE_JOINTS,
        palm_offset_m=palm_offset_m,
    )


def allegro_volume(palm_offset_m: Sequence[float] = (0.0, 0.0, 0.0)) -> HandVolume:
    """The space that the right Allegro hand takes up, for the theta of `allegro_hand`.

    Raises:
        InputError: the hand's model is not installed.
    """
    return HandVolume.from_urdf(
        allegro_urdf(),
        palm_link=PALM_LINK,
        tip_links=TIP_LINKS,
        preshape_joints=PRESHAPE_JOINTS,
        palm_offset_m=palm_offset_m,
    )


def allegro_urdf() -> Path:
    """The hand's URDF among the files of the installed package.

    Raises:
        InputError: the package is not installed, or does not have the file.
    """
    name = "example-robot-data"
    try:
        files = distribution(name).files or []
    except PackageNotFoundError:
        files = []
    for file in files:
        path = Path(str(file.locate()))
        if path.name == "allegro_right_hand.urdf" and path.is_file():
            return path
    raise InputError(
        "The Allegro hand's model is not installed",
        where=f"package {name}",
        fix="install the locked packages: pip install -r requirements.lock",
    )
