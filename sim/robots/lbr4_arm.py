"""A KUKA LBR4+ arm (paper, section 4.1) with a hand at its flange."""

import hashlib
from copy import deepcopy
from pathlib import Path

import numpy as np
from jaxtyping import Float
from lxml import etree
from lxml.builder import E

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace
from sim.robots.description import RobotDescription, RobotSettings
from sim.robots.hand_model import HandModel
from sim.robots.inertia import cylinder_inertial

ARM_URDF = Path(__file__).with_name("lbr4.urdf")
FLANGE_LINK = "lbr4_7_link"
MOUNT_RADIUS_M = 0.04
MOUNT_DENSITY = 2700.0
ROOT_LINK = "lbr4_base_link"


def arm_with_hand(
    settings: RobotSettings, hand: HandModel, grasp_space: GraspSpace, cache: str | Path
) -> RobotDescription:
    """Put arm, mount and hand together.

    The URDF is written to `cache` under a name made from its content, so an existing one is never changed.

    Args:
        settings: choices about the robot.
        hand: what the arm carries.
        grasp_space: the grasp space of its preshape joints.
        cache: folder for derived files.

    Raises:
        InputError: if the settings do not fit the robot, or `cache` cannot be written to.
    """
    urdf = _assemble(settings, hand)
    _check_settings(settings, grasp_space, urdf)
    return _describe(settings, hand, grasp_space, urdf, _write(urdf, Path(cache)))


def _mount(hand: HandModel) -> str:
    return f"{hand.name}_mount"


def _assemble(settings: RobotSettings, hand: HandModel) -> etree._Element:
    robot = etree.parse(ARM_URDF).getroot()
    robot.set("name", settings.name)
    for shape in robot.findall(f"link[@name='{ROOT_LINK}']/*[@name='pedestal']"):
        shape.find("origin").set("xyz", f"0 0 {-settings.base_height_m / 2:g}")
        shape.find("geometry/cylinder").set("length", f"{settings.base_height_m:g}")
    length = settings.mount_length_m
    mount, height = _mount(hand), length + hand.flange_to_palm_link_m
    robot.append(_mount_link(mount, length))
    robot.append(_fixed_joint(FLANGE_LINK, mount, 0.0, settings.mount_yaw_rad))
    robot.append(_fixed_joint(mount, hand.palm_link, height, 0.0))
    robot.extend(deepcopy(list(hand.urdf)))
    return robot


def _mount_link(name: str, length: float) -> etree._Element:
    radius = MOUNT_RADIUS_M
    mass = MOUNT_DENSITY * np.pi * radius**2 * length

    def cylinder() -> list[etree._Element]:
        size = {"radius": f"{radius:g}", "length": f"{length:g}"}
        return [E.origin(xyz=f"0 0 {length / 2:g}"), E.geometry(E.cylinder(size))]

    return E.link(
        E.visual(*cylinder(), E.material(name="silver")),
        E.collision(*cylinder()),
        cylinder_inertial(mass, radius, length, length / 2),
        name=name,
    )


def _fixed_joint(parent: str, child: str, height: float, yaw: float) -> etree._Element:
    origin = E.origin(xyz=f"0 0 {height:g}", rpy=f"0 0 {yaw:.9g}")
    return E.joint(E.parent(link=parent), E.child(link=child), origin, name=f"{child}_joint", type="fixed")


def _write(urdf: etree._Element, cache: Path) -> Path:
    etree.indent(urdf)
    content = etree.tostring(urdf, encoding="utf-8", xml_declaration=True)
    path = cache / "robots" / f"{urdf.attrib['name']}_{hashlib.sha256(content).hexdigest()[:16]}.urdf"
    if not path.is_file():
        with atomic_path(path) as temporary:
            temporary.write_bytes(content)
    return path.resolve()


def _check_settings(settings: RobotSettings, grasp_space: GraspSpace, urdf: etree._Element) -> None:
    where = f"robot={settings.name}"
    arm, hand = _moving_joints(urdf)
    if set(settings.preshape_mapping) != set(grasp_space.joint_names):
        raise InputError(
            f"preshape_mapping names {', '.join(settings.preshape_mapping)}, but the grasp space has "
            f"{', '.join(grasp_space.joint_names)}",
            where=where,
            fix="give each joint of the grasp space one joint of the URDF",
        )
    unknown = {*settings.preshape_mapping.values(), *settings.hand_open_rad} - set(hand)
    if unknown:
        raise InputError(
            f"The hand has no joint {', '.join(sorted(unknown))}",
            where=where,
            fix=f"choose from {list(hand)}",
        )
    if len(settings.arm_accelerations) != len(arm):
        raise InputError(
            f"arm_accelerations has {len(settings.arm_accelerations)} entries",
            where=where,
            fix=f"give {len(arm)}, one for each joint of the arm",
        )
    lower, upper = _limits(arm, "lower"), _limits(arm, "upper")
    home = np.array(settings.arm_home_rad)
    if home.shape != lower.shape or np.any(home < lower) or np.any(home > upper):
        raise InputError(
            f"arm_home_rad must be {len(arm)} angles within the arm's limits",
            where=where,
            fix=f"stay between {lower.round(3).tolist()} and {upper.round(3).tolist()}",
        )


def _moving_joints(urdf: etree._Element) -> tuple[dict[str, etree._Element], dict[str, etree._Element]]:
    """Joints of the arm and of the hand by name."""
    moving = (joint for joint in urdf.findall("joint") if joint.attrib["type"] in ("revolute", "prismatic"))
    joints = {joint.attrib["name"]: joint for joint in moving}
    arm = {name: joint for name, joint in joints.items() if name.startswith("lbr4_")}
    return arm, {name: joint for name, joint in joints.items() if name not in arm}


def _limits(joints: dict[str, etree._Element], key: str) -> Float[np.ndarray, "n"]:
    return np.array([float(joint.find("limit").attrib[key]) for joint in joints.values()])


def _describe(
    settings: RobotSettings, hand: HandModel, grasp_space: GraspSpace, urdf: etree._Element, path: Path
) -> RobotDescription:
    arm, joints = _moving_joints(urdf)
    links = [link.attrib["name"] for link in urdf.findall("link")]
    hand_links = tuple(links[links.index(hand.palm_link) :])
    hand_lower, hand_upper = _limits(joints, "lower"), _limits(joints, "upper")
    hand_open = np.array([settings.hand_open_rad.get(name, 0.0) for name in joints])
    return RobotDescription(
        name=settings.name,
        urdf_path=path,
        grasp_space=grasp_space,
        arm_joints=tuple(arm),
        hand_joints=tuple(joints),
        fingers=hand.fingers,
        fingertip_links=hand.fingertip_links,
        palm_link=hand.palm_link,
        arm_links=tuple(link for link in links if link not in hand_links),
        hand_links=hand_links,
        finger_base_links=hand.finger_base_links,
        disabled_pairs=_parent_child_pairs(urdf) + _overlapping_pairs(_mount(hand)) + hand.overlapping_pairs,
        preshape_mapping=dict(settings.preshape_mapping),
        T_world_base=make_pose(np.eye(3), np.array([0.0, 0.0, settings.base_height_m])),
        T_link_palm=make_pose(hand.R_link_palm, np.array(settings.palm_offset_m)),
        arm_home=np.array(settings.arm_home_rad),
        hand_open=np.clip(hand_open, hand_lower, hand_upper),
        arm_lower_limits=_limits(arm, "lower"),
        arm_upper_limits=_limits(arm, "upper"),
        arm_velocities=_limits(arm, "velocity"),
        arm_accelerations=np.array(settings.arm_accelerations),
        hand_lower_limits=hand_lower,
        hand_upper_limits=hand_upper,
        arm_torque_limits=_limits(arm, "effort"),
        hand_torque_limit=settings.hand_torque_limit,
        arm_stiffness=settings.arm_stiffness,
        arm_damping=settings.arm_damping,
        hand_stiffness=settings.hand_stiffness,
        hand_damping=settings.hand_damping,
        hand_armature=settings.hand_armature,
    )


def _parent_child_pairs(urdf: etree._Element) -> tuple[tuple[str, str], ...]:
    return tuple(
        (joint.find("parent").attrib["link"], joint.find("child").attrib["link"])
        for joint in urdf.findall("joint")
    )


def _overlapping_pairs(mount: str) -> tuple[tuple[str, str], ...]:
    """Shapes that overlap by design: forearm and wrist reach around the flange."""
    return (("lbr4_5_link", FLANGE_LINK), ("lbr4_5_link", mount), ("lbr4_6_link", mount))
