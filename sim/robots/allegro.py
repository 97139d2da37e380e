"""The right Allegro hand of the `example-robot-data` package, made fit for simulation."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
from jaxtyping import Float
from lxml import etree
from lxml.builder import E

from preshape.errors import InputError
from sim.robots.hand_model import HandModel
from sim.robots.inertia import numbers, spread_over_boxes

PALM_LINK = "palm_link"
FLANGE_TO_PALM_LINK_M = 0.095
FINGERS = {"index": 0, "middle": 4, "ring": 8, "thumb": 12}
"""Finger -> number of its first joint; each finger has four."""

# Centre and size (m) of boxes that follow the palm's outline, which narrows towards the flange.
PALM_BOXES = (
    ((-0.0090, 0.00000, -0.02300), (0.0414, 0.1120, 0.0448)),
    ((-0.0090, -0.0253, -0.06670), (0.0414, 0.0538, 0.0428)),
    ((-0.0093, -0.00557, -0.08874), (0.0414, 0.0720, 0.0130)),
)


def finger_joints(finger: str) -> tuple[str, ...]:
    """Joint names of a finger, from the palm to the tip."""
    first = FINGERS[finger]
    return tuple(f"joint_{number}.0" for number in range(first, first + 4))


def fingertip_link(finger: str) -> str:
    """Name of the link at the tip of a finger."""
    return f"link_{FINGERS[finger] + 3}.0_tip"


def allegro_hand(torque_limit: float) -> HandModel:
    """The hand as an arm carries it.

    Its palm frame is its palm link's: x out of the palm, z along the middle finger.

    Args:
        torque_limit: of each joint (Nm).

    Raises:
        InputError: if the package, or a mesh of it, is not installed.
    """
    return HandModel(
        name="allegro",
        urdf=load_hand(torque_limit),
        palm_link=PALM_LINK,
        flange_to_palm_link_m=FLANGE_TO_PALM_LINK_M,
        fingers={finger: finger_joints(finger) for finger in FINGERS},
        fingertip_links={finger: fingertip_link(finger) for finger in FINGERS},
        finger_base_links=tuple(f"link_{first}.0" for first in FINGERS.values()),
        overlapping_pairs=(),
        R_link_palm=np.eye(3),
    )


def load_hand(torque_limit: float) -> etree._Element:
    """The hand as a URDF tree whose root link is the palm.

    The file's own inertias are placed at the joints and its torques and joint friction are nominal, so masses
    are spread over the collision boxes instead, torques are limited to `torque_limit` (Nm), and friction and
    damping are left to the drives. Mesh paths are absolute.

    Raises:
        InputError: if the package, or a mesh of it, is not installed.
    """
    robots = _robots_folder()
    hand = _read(robots / "allegro_hand_description" / "urdf" / "allegro_right_hand.urdf")
    for mesh in hand.iter("mesh"):
        mesh.set("filename", str(_mesh_path(mesh.attrib["filename"], robots)))
    palm = hand.find(f"link[@name='{PALM_LINK}']")
    for collision in palm.findall("collision"):
        palm.remove(collision)
    palm.extend(_box_collision(centre, size) for centre, size in PALM_BOXES)
    for link in hand.findall("link"):
        _spread_mass(link)
    for joint in hand.findall("joint[@type='revolute']"):
        joint.remove(joint.find("dynamics"))
        joint.find("limit").set("effort", f"{torque_limit:g}")
    return hand


def _robots_folder() -> Path:
    # Found through a module of the same package: a `cmeel` wheel puts its data beside its code.
    spec = find_spec("cmeel")
    roots = [Path(entry).parent for entry in (spec.submodule_search_locations or ())] if spec else []
    for root in roots:
        folder = root / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    raise InputError(
        "The Allegro hand's model is not installed",
        where="cmeel.prefix/share/example-robot-data/robots",
        fix="install the locked packages: pip install -r requirements.lock",
    )


def _read(path: Path) -> etree._Element:
    try:
        return etree.parse(path).getroot()
    except (OSError, etree.XMLSyntaxError) as error:
        raise InputError(
            f"The Allegro hand's model cannot be read: {error}",
            where=path,
            fix="install it again: pip install --force-reinstall example-robot-data",
        ) from error


def _mesh_path(uri: str, robots: Path) -> Path:
    path = robots.parent.parent / uri.removeprefix("package://")
    if not path.is_file():
        raise InputError(
            "A mesh of the Allegro hand is missing",
            where=path,
            fix="install it again: pip install --force-reinstall example-robot-data",
        )
    return path


def _spread_mass(link: etree._Element) -> None:
    """Place the link's mass evenly over its collision shapes."""
    mass = float(link.find("inertial/mass").attrib["value"])
    link.replace(link.find("inertial"), spread_over_boxes(mass, *_boxes(link)))


def _boxes(link: etree._Element) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Centres and sizes (m) of boxes around the link's collision shapes."""
    centres, sizes = [], []
    for collision in link.findall("collision"):
        geometry = collision.find("geometry")[0]
        origin = collision.find("origin")
        centres.append(_vector(origin.attrib["xyz"] if origin is not None else "0 0 0"))
        if geometry.tag == "box":
            sizes.append(_vector(geometry.attrib["size"]))
        else:
            # A cube with the inertia of the fingertip's sphere: a^2/6 = 2/5 r^2.
            sizes.append(np.full(3, np.sqrt(12 / 5) * float(geometry.attrib["radius"])))
    return np.array(centres), np.array(sizes)


def _box_collision(centre: tuple[float, ...], size: tuple[float, ...]) -> etree._Element:
    return E.collision(E.origin(xyz=numbers(centre)), E.geometry(E.box(size=numbers(size))))


def _vector(text: str) -> Float[np.ndarray, "3"]:
    return np.array([float(number) for number in text.split()])
