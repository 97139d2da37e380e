"""One fresh physical world: a table, an object on it and, if asked for, a robot."""

from typing import Self

import numpy as np
import sapien
from jaxtyping import Float

from sim.objects.actor import add_object
from sim.objects.object_model import ObjectModel
from sim.physics import PhysicsSettings, make_scene
from sim.robots.description import RobotDescription
from sim.simulated_robot import SimulatedRobot
from sim.table import TableSettings, build_table

TOUCHING_M = 1e-3
"""Contact points closer than this, or with an impulse, count as touching."""


class World:
    """A table with an object.

    Args:
        table, physics: what the world is made of.
        model: the object.
        T_world_object: its pose.
        rendered: whether the world can be looked at.
    """

    def __init__(
        self,
        table: TableSettings,
        physics: PhysicsSettings,
        model: ObjectModel,
        T_world_object: Float[np.ndarray, "4 4"],
        *,
        rendered: bool = False,
    ) -> None:
        self.scene = make_scene(physics, rendered=rendered)
        self._supports = set(build_table(self.scene, table))
        self._object = add_object(self.scene, model, T_world_object)
        self._body = self._object.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        self.robot: SimulatedRobot | None = None

    def with_robot(self, robot: RobotDescription) -> Self:
        """The same world with a robot in it."""
        self.robot = SimulatedRobot(self.scene, robot)
        return self

    def step(self) -> None:
        """Advance by one physics step."""
        self.scene.step()

    @property
    def object_pose(self) -> Float[np.ndarray, "4 4"]:
        """T_world_object as it is now."""
        return self._object.pose.to_transformation_matrix().astype(np.float64)

    @property
    def object_height_m(self) -> float:
        """Height of the object's centre of mass over the floor."""
        return float(self._object.pose.p[2])

    @property
    def object_speeds(self) -> tuple[float, float]:
        """Linear (m/s) and angular (rad/s) speed of the object."""
        linear, angular = self._body.linear_velocity, self._body.angular_velocity
        return float(np.linalg.norm(linear)), float(np.linalg.norm(angular))

    @property
    def object_velocity(self) -> Float[np.ndarray, "3"]:
        """Linear velocity of the object's centre of mass (m/s, world)."""
        return np.asarray(self._body.linear_velocity, dtype=np.float64)

    @property
    def object_touches_hand(self) -> bool:
        """Whether any link of the hand touches the object."""
        return self.robot is not None and bool(self._touching() & self.robot.hand_links)

    @property
    def object_touches_support(self) -> bool:
        """Whether the table or the floor touches the object."""
        return bool(self._touching() & self._supports)

    @property
    def hand_contacts(self) -> list[tuple[str, Float[np.ndarray, "3"]]]:
        """Points (m, world) where the hand touches the object, each with the name of the hand's link."""
        hand = set() if self.robot is None else self.robot.hand_links
        return [
            (body.name, np.asarray(point.position, dtype=np.float64))
            for contact in self.scene.get_contacts()
            if self._object in {body.entity for body in contact.bodies}
            for body in contact.bodies
            if body.entity in hand
            for point in contact.points
            if _touches(point)
        ]

    def _touching(self) -> set[sapien.Entity]:
        touching = set()
        for contact in self.scene.get_contacts():
            entities = {body.entity for body in contact.bodies}
            if self._object in entities and any(_touches(point) for point in contact.points):
                touching |= entities
        return touching - {self._object}


def _touches(point: sapien.physx.PhysxContactPoint) -> bool:
    return point.separation < TOUCHING_M or bool(np.any(point.impulse))
