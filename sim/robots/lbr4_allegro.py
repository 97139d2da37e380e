"""A KUKA LBR4+ arm with a right Allegro hand (paper, section 4.1)."""

import hashlib
from pathlib import Path

import numpy as np
from jaxtyping import Float
from lxml import etree
from lxml.builder import E

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace
from sim.robots import allegro
from sim.robots.description import RobotDescription, RobotSettings

ARM_URDF = Path(__file__).with_name("lbr4.urdf")
FLANGE_LINK = "lbr4_7_link"
MOUNT_LINK = "allegro_mount"
MOUNT_RADIUS_M = 0.04
MOUNT_DENSITY = 2700.0
ROOT_LINK = "lbr4_base_link"

# Shapes that overlap by design: forearm and wrist reach around the flange.
OVERLAPPING_PAIRS = (
    ("lbr4_5_link", FLANGE_LINK),
    ("lbr4_5_link", MOUNT_LINK),
    ("lbr4_6_link", MOUNT_LINK),
)


def load_robot(settings: RobotSettings, grasp_space: GraspSpace, cache: str | Path) -> RobotDescription:
    """Put arm, mount and hand together.

    The URDF is written to `cache` under a name made from its content, so an existing one is never changed.

    Args:
        settings: choices about the robot.
        grasp_space: the grasp space of its preshape joints.
        cache: folder for derived files.

    Raises:
        InputError: if the hand's model is missing, the settings do not fit the robot, or `cache` cannot be
            written to.
    """
    urdf = _assemble(settings)
    _check_settings(settings, grasp_space, urdf)
    return _describe(settings, grasp_space, urdf, _write(urdf, Path(cache)))


def _assemble(settings: RobotSettings) -> etree._Element:
    robot = etree.parse(ARM_URDF).getroot()
    robot.set("name", settings.name)
    for shape in robot.findall(f"link[@name='{ROOT_LINK}']/*[@name='pedestal']"):
        shape.find("origin").set("xyz", f"0 0 {-settings.base_height_m / 2:g}")
        shape.find("geometry/cylinder").set("length", f"{settings.base_height_m:g}")
    length = settings.mount_length_m
    robot.append(_mount_link(length))
    robot.append(_fixed_joint(FLANGE_LINK, MOUNT_LINK, 0.0, settings.mount_yaw_rad))
    robot.append(_fixed_joint(MOUNT_LINK, allegro.PALM_LINK, length + allegro.FLANGE_TO_PALM_LINK_M, 0.0))
    robot.extend(list(allegro.load_hand(settings.hand_torque_limit)))
    return robot


def _mount_link(length: float) -> etree._Element:
    radius = MOUNT_RADIUS_M
    mass = MOUNT_DENSITY * np.pi * radius**2 * length
    across, along = mass * (3 * radius**2 + length**2) / 12, mass * radius**2 / 2
    centre = np.array([0.0, 0.0, length / 2])

    def cylinder() -> list[etree._Element]:
        size = {"radius": f"{radius:g}", "length": f"{length:g}"}
        return [E.origin(xyz=f"0 0 {length / 2:g}"), E.geometry(E.cylinder(size))]

    return E.link(
        E.visual(*cylinder(), E.material(name="silver")),
        E.collision(*cylinder()),
        allegro.inertial_element(mass, centre, np.diag([across, across, along])),
        name=MOUNT_LINK,
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
    arm, hand = _revolute_joints(urdf)
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


def _revolute_joints(urdf: etree._Element) -> tuple[dict[str, etree._Element], dict[str, etree._Element]]:
    """Joints of the arm and of the hand by name."""
    joints = {joint.attrib["name"]: joint for joint in urdf.findall("joint[@type='revolute']")}
    arm = {name: joint for name, joint in joints.items() if name.startswith("lbr4_")}
    return arm, {name: joint for name, joint in joints.items() if name not in arm}


def _limits(joints: dict[str, etree._Element], key: str) -> Float[np.ndarray, "n"]:
    return np.array([float(joint.find("limit").attrib[key]) for joint in joints.values()])


def _describe(
    settings: RobotSettings, grasp_space: GraspSpace, urdf: etree._Element, path: Path
) -> RobotDescription:
    arm, hand = _revolute_joints(urdf)
    links = [link.attrib["name"] for link in urdf.findall("link")]
    hand_links = tuple(links[links.index(allegro.PALM_LINK) :])
    hand_lower, hand_upper = _limits(hand, "lower"), _limits(hand, "upper")
    hand_open = np.array([settings.hand_open_rad.get(name, 0.0) for name in hand])
    return RobotDescription(
        name=settings.name,
        urdf_path=path,
        grasp_space=grasp_space,
        arm_joints=tuple(arm),
        hand_joints=tuple(hand),
        fingers={finger: allegro.finger_joints(finger) for finger in allegro.FINGERS},
        fingertip_links={finger: allegro.fingertip_link(finger) for finger in allegro.FINGERS},
        palm_link=allegro.PALM_LINK,
        arm_links=tuple(link for link in links if link not in hand_links),
        hand_links=hand_links,
        finger_base_links=tuple(f"link_{first}.0" for first in allegro.FINGERS.values()),
        disabled_pairs=_parent_child_pairs(urdf) + OVERLAPPING_PAIRS,
        preshape_mapping=dict(settings.preshape_mapping),
        T_world_base=make_pose(np.eye(3), np.array([0.0, 0.0, settings.base_height_m])),
        T_link_palm=make_pose(np.eye(3), np.array(settings.palm_offset_m)),
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
