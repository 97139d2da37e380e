"""What a robot at rest looks like, as a digest that is the same on every machine."""

import hashlib
from pathlib import Path

from lxml import etree

from preshape.files import file_hash
from sim.robots.description import RobotDescription

INVISIBLE = ("collision", "inertial", "limit", "dynamics")
"""Elements of a URDF that no picture depends on."""


def appearance_digest(robot: RobotDescription) -> str:
    """Hash of all that a picture of the robot in its rest pose depends on; of meshes, what is in them.

    Raises:
        InputError: if a mesh cannot be read.
    """
    urdf = etree.parse(robot.urdf_path).getroot()
    etree.strip_elements(urdf, *INVISIBLE)
    for mesh in urdf.iter("mesh"):
        mesh.set("filename", file_hash(Path(mesh.attrib["filename"])))
    pose = (robot.T_world_base.tolist(), robot.arm_home.tolist(), robot.hand_open.tolist())
    return hashlib.sha256(etree.tostring(urdf, method="c14n") + repr(pose).encode()).hexdigest()
