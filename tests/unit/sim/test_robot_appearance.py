"""The robot's appearance as a digest: the same on every machine, whatever drives it."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from sim.robots.appearance import appearance_digest
from sim.robots.description import RobotDescription


@pytest.fixture
def moved(robot: RobotDescription, tmp_path: Path) -> RobotDescription:
    """The same robot whose meshes lie elsewhere."""
    urdf = etree.parse(robot.urdf_path)
    for mesh in urdf.iter("mesh"):
        copy = tmp_path / Path(mesh.attrib["filename"]).name
        shutil.copy(mesh.attrib["filename"], copy)
        mesh.set("filename", str(copy))
    urdf.write(tmp_path / "robot.urdf")
    return replace(robot, urdf_path=tmp_path / "robot.urdf")


def test_where_meshes_lie_does_not_matter_but_what_is_in_them(
    robot: RobotDescription, moved: RobotDescription
) -> None:
    assert appearance_digest(moved) == appearance_digest(robot)
    mesh = next(etree.parse(moved.urdf_path).iter("mesh")).attrib["filename"]
    with Path(mesh).open("ab") as handle:
        handle.write(b" ")
    assert appearance_digest(moved) != appearance_digest(robot)


@pytest.mark.parametrize(("element", "key", "seen"), [("limit", "effort", False), ("origin", "xyz", True)])
def test_only_what_is_seen_counts(moved: RobotDescription, element: str, key: str, seen: bool) -> None:
    before = appearance_digest(moved)
    urdf = etree.parse(moved.urdf_path)
    next(urdf.find("joint[@type='revolute']").iter(element)).set(key, "0.5 0 0" if seen else "7")
    urdf.write(moved.urdf_path)
    assert (appearance_digest(moved) != before) is seen


def test_the_pose_counts(robot: RobotDescription) -> None:
    turned = replace(robot, arm_home=robot.arm_home + 0.1)
    assert appearance_digest(turned) != appearance_digest(robot)
