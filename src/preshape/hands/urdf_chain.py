"""Chains of joints read from a URDF."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from lxml import etree
from scipy.spatial.transform import Rotation

from preshape.errors import InputError
from preshape.geometry.pose import make_pose


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint of a URDF.

    Args:
        name: name of the joint.
        T_parent_child: pose of the child link in the parent link at angle zero.
        axis: unit vector of its axis in the child link; zero for a fixed joint.
    """

    name: str
    T_parent_child: Float[np.ndarray, "4 4"]
    axis: Float[np.ndarray, "3"]


@dataclass(frozen=True, eq=False)
class Box:
    """A box fixed to a link: its pose in the link and the lengths of its sides (m)."""

    T_link_box: Float[np.ndarray, "4 4"]
    extents: Float[np.ndarray, "3"]


class Urdf:
    """The tree of links and joints in a URDF file.

    Raises:
        InputError: the file is missing or is no URDF.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._robot: Any = etree.parse(path).getroot()
        except (OSError, etree.XMLSyntaxError) as error:
            raise self._error(f"The hand's URDF cannot be read ({error})") from error
        self._joint_to = {joint.find("child").get("link"): joint for joint in self._robot.findall("joint")}

    def chain(self, root: str, tip: str) -> tuple[Joint, ...]:
        """Joints from link `root` to link `tip`, which are all revolute or fixed.

        Raises:
            InputError: no such chain exists.
        """
        return tuple(self._joint(self._joint_to[link]) for link in self.links(root, tip))

    def links(self, root: str, tip: str) -> tuple[str, ...]:
        """Links after link `root`, up to and with link `tip`: the children of the joints of `chain`.

        Raises:
            InputError: no such chain exists.
        """
        links: list[str] = []
        link = tip
        while link != root:
            if link not in self._joint_to:
                raise self._error(f"The hand's URDF has no chain of joints from {root} to {tip}")
            links.append(link)
            link = self._joint_to[link].find("parent").get("link")
        return tuple(reversed(links))

    def collision_box(self, link: str) -> Box:
        """First box among the collision shapes of a link.

        Raises:
            InputError: the link has none.
        """
        for box in self.collision_boxes(link):
            return box
        raise self._error(f"Link {link} of the hand's URDF has no collision box")

    def collision_boxes(self, link: str) -> tuple[Box, ...]:
        """Boxes among the collision shapes of a link; spheres count as the cubes around them."""
        boxes = []
        for collision in self._robot.findall(f"link[@name='{link}']/collision"):
            box, sphere = collision.find("geometry/box"), collision.find("geometry/sphere")
            if box is not None:
                boxes.append(Box(_origin(collision), _numbers(box.get("size"))))
            elif sphere is not None:
                boxes.append(Box(_origin(collision), np.full(3, 2 * float(sphere.get("radius")))))
        return tuple(boxes)

    def _joint(self, joint: Any) -> Joint:
        name, kind = joint.get("name"), joint.get("type")
        if kind == "fixed":
            return Joint(name, _origin(joint), np.zeros(3))
        if kind not in ("revolute", "continuous"):
            raise self._error(f"Joint {name} of the hand's URDF is {kind}, neither revolute nor fixed")
        axis = joint.find("axis")
        direction = _numbers("1 0 0" if axis is None else axis.get("xyz"))
        return Joint(name, _origin(joint), direction / np.linalg.norm(direction))

    def _error(self, what: str) -> InputError:
        return InputError(what, where=self.path, fix="choose the URDF, links and joints that fit together")


def _origin(element: Any) -> Float[np.ndarray, "4 4"]:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    rpy = Rotation.from_euler("xyz", _numbers(origin.get("rpy", "0 0 0")))
    return make_pose(rpy.as_matrix(), _numbers(origin.get("xyz", "0 0 0")))


def _numbers(text: str) -> Float[np.ndarray, "3"]:
    return np.array([float(number) for number in text.split()])
