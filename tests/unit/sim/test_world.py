"""What counts as support and what as hand."""

import numpy as np
import pytest

from preshape.geometry.pose import make_pose
from sim.objects.grocery import GrocerySet
from sim.physics import PhysicsSettings
from sim.robots.description import RobotDescription
from sim.table import TableSettings
from sim.world import World

MODEL = GrocerySet().load("spam")
TABLE = TableSettings()


def world_with_object_at(position: np.ndarray) -> World:
    return World(TABLE, PhysicsSettings(), MODEL, make_pose(np.eye(3), position))


def touches_anything(world: World) -> bool:
    return any(np.any(point.impulse) for contact in world.scene.get_contacts() for point in contact.points)


def test_an_object_on_the_table_is_supported() -> None:
    world = world_with_object_at(np.array([0.8, 0.0, TABLE.top_m + MODEL.standing_height_m]))
    for _ in range(20):
        world.step()
    assert world.object_touches_support
    assert not world.object_touches_hand
    assert world.object_pose[2, 3] == pytest.approx(TABLE.top_m + MODEL.standing_height_m, abs=1e-3)


def test_a_falling_object_touches_nothing() -> None:
    world = world_with_object_at(np.array([0.8, 0.0, TABLE.top_m + 0.5]))
    world.step()
    assert not world.object_touches_support
    assert world.object_velocity[2] < 0


@pytest.mark.parametrize(
    ("link", "is_hand"), [("lbr4_6_link", False), ("palm_link", True)], ids=["the wrist", "the palm"]
)
def test_the_arm_is_neither_support_nor_hand(robot: RobotDescription, link: str, is_hand: bool) -> None:
    probe = world_with_object_at(np.array([0.8, 0.0, 1.5])).with_robot(robot)
    probe.robot.place(robot.arm_home, robot.hand_open)
    place = probe.robot.articulation.find_link_by_name(link).entity_pose.p.astype(float)
    world = world_with_object_at(place).with_robot(robot)
    world.robot.place(robot.arm_home, robot.hand_open)
    world.step()
    assert touches_anything(world)
    assert world.object_touches_hand == is_hand
    assert not world.object_touches_support
