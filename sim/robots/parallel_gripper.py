"""The electric parallel gripper of Rethink Robotics' Baxter, from its published description."""

from dataclasses import dataclass

import numpy as np
from lxml import etree
from lxml.builder import E

from preshape.errors import InputError
from sim.robots.hand_model import HandModel
from sim.robots.inertia import cylinder_inertial, numbers, spread_over_boxes

BASE_LINK = "gripper_base"
FLANGE_TO_BASE_M = 0.025
BASE_MASS, BASE_RADIUS_M, BASE_LENGTH_M = 0.3, 0.029, 0.1
SLIDE_HEIGHT_M = 0.02
"""Height of the slides over the base's frame; the housing ends there."""
STROKE_M, EFFORT_N, SPEED_M_S = 0.020833, 20.0, 5.0
"""Of each finger."""
SLOTS = range(2, 5)
"""There is a first one, too, in which the faces meet before the stroke ends."""
SLOT_PITCH_M = 0.0095
FINGER_MASS = 0.03
"""A finger with its paddle."""
# Centre and size (m) of the boxes of the left finger, a long one with a paddle, in its frame.
FINGER_BOXES = {
    "knuckle": ((-0.005, -0.003, 0.0083), (0.010, 0.050, 0.017)),
    "finger": ((0.0, 0.01725, 0.0615), (0.010, 0.0135, 0.1127)),
    "paddle": ((0.0, 0.01275, 0.0977), (0.042, 0.0065, 0.037)),
}
COLOURS = {"knuckle": "0.75 0.75 0.77 1", "finger": "0.16 0.16 0.18 1", "paddle": "0.55 0.10 0.08 1"}
REACH_M = SLIDE_HEIGHT_M + 0.0615 + 0.1127 / 2
"""From the base's frame to the fingers' ends."""
# x: the direction in which the gripper approaches, y: along the opening.
R_LINK_PALM = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


@dataclass(frozen=True)
class ParallelGripper:
    """How the gripper is set up.

    Its motor moves both fingers by 20.8 mm each. Where that stroke lies is chosen by the slot in which the
    fingers are screwed on: the paddles' faces are 16-58, 35-77 or 54-96 mm apart.

    Args:
        slot: 2, 3 or 4.

    Raises:
        InputError: if there is no such slot.
    """

    slot: int

    def __post_init__(self) -> None:
        if self.slot not in SLOTS:
            raise InputError(
                f"The gripper has no slot {self.slot}", where="slot", fix="choose one from 2 to 4"
            )

    @property
    def widest_m(self) -> float:
        """How far the paddles are apart when it is open."""
        return self.narrowest_m + 2 * STROKE_M

    @property
    def narrowest_m(self) -> float:
        """How far the paddles are apart when it is closed."""
        return 2 * (SLOT_PITCH_M * (self.slot - 1) - 0.0015)

    def closed_by(self, opening_m: float) -> float:
        """How far each finger has moved inwards (m) where the paddles are so far apart, within the stroke."""
        return float(np.clip((self.widest_m - opening_m) / 2, 0.0, STROKE_M))

    def opening(self, closed_by_m: float) -> float:
        """How far the paddles are apart (m) where the fingers have moved inwards so far on average."""
        return self.widest_m - 2 * closed_by_m

    def hand(self) -> HandModel:
        """The gripper as an arm carries it.

        Its joints count how far the fingers have moved inwards, so that it closes as other hands do. The
        right finger follows the left one, since one motor moves both.
        """
        urdf = E.robot(_base(), *_finger("left", 1.0, self.slot), *_finger("right", -1.0, self.slot))
        return HandModel(
            name="gripper",
            urdf=urdf,
            palm_link=BASE_LINK,
            flange_to_palm_link_m=FLANGE_TO_BASE_M,
            fingers={side: (f"{side}_finger_joint",) for side in ("left", "right")},
            fingertip_links={side: f"{side}_finger" for side in ("left", "right")},
            finger_base_links=("left_finger", "right_finger"),
            overlapping_pairs=(("left_finger", "right_finger"),),
            R_link_palm=R_LINK_PALM,
        )


def _base() -> etree._Element:
    middle = SLIDE_HEIGHT_M - BASE_LENGTH_M / 2

    def housing() -> list[etree._Element]:
        size = {"radius": f"{BASE_RADIUS_M:g}", "length": f"{BASE_LENGTH_M:g}"}
        return [E.origin(xyz=f"0 0 {middle:g}"), E.geometry(E.cylinder(size))]

    return E.link(
        E.visual(*housing(), E.material(E.color(rgba="0.30 0.30 0.33 1"), name="housing")),
        E.collision(*housing()),
        cylinder_inertial(BASE_MASS, BASE_RADIUS_M, BASE_LENGTH_M, middle),
        name=BASE_LINK,
    )


def _finger(name: str, side: float, slot: int) -> tuple[etree._Element, etree._Element]:
    """A finger with its slide; `side` is 1 on the left, where y is positive, and -1 on the right."""
    turned = np.array([side, side, 1.0])
    boxes = {part: (turned * centre, size) for part, (centre, size) in FINGER_BOXES.items()}
    link = E.link(name=f"{name}_finger")
    for part, (centre, size) in boxes.items():
        shape = [E.origin(xyz=numbers(centre)), E.geometry(E.box(size=numbers(size)))]
        material = E.material(E.color(rgba=COLOURS[part]), name=part)
        link.append(E.visual(*shape, material))
        link.append(E.collision(E.origin(xyz=numbers(centre)), E.geometry(E.box(size=numbers(size)))))
    centres, sizes = (np.array(column) for column in zip(*boxes.values(), strict=True))
    link.append(spread_over_boxes(FINGER_MASS, centres, sizes))
    closed_m = SLOT_PITCH_M * (slot - 1) - 0.011
    joint = E.joint(
        E.parent(link=BASE_LINK),
        E.child(link=f"{name}_finger"),
        E.origin(xyz=numbers((0.0, side * (closed_m + STROKE_M), SLIDE_HEIGHT_M))),
        E.axis(xyz=numbers((0.0, -side, 0.0))),
        E.limit(lower="0", upper=f"{STROKE_M:g}", effort=f"{EFFORT_N:g}", velocity=f"{SPEED_M_S:g}"),
        name=f"{name}_finger_joint",
        type="prismatic",
    )
    if name == "right":
        joint.append(E.mimic(joint="left_finger_joint", multiplier="1", offset="0"))
    return link, joint
