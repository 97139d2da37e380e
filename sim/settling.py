"""Putting an object on the table and letting it come to rest."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from preshape.geometry.pose import make_pose
from sim.objects.object_model import ObjectModel
from sim.physics import PhysicsSettings
from sim.table import TableSettings
from sim.world import World


@dataclass(frozen=True)
class PlacementSettings:
    """Where objects are put (paper, section 4.1), and when they are at rest.

    Args:
        square_m: side of the square around the table's centre in which the origin is uniform, as the yaw is.
        drop_height_m: height from which the object is let go.
        rest_time_s: how long it must have been slow to be at rest.
        max_time_s: when to give up.
        linear_speed_m_s, angular_speed_rad_s: what slow means.
    """

    square_m: float = 0.2
    drop_height_m: float = 0.002
    rest_time_s: float = 0.25
    max_time_s: float = 4.0
    linear_speed_m_s: float = 0.005
    angular_speed_rad_s: float = 0.05


def place_object(
    model: ObjectModel,
    table: TableSettings,
    physics: PhysicsSettings,
    placement: PlacementSettings,
    rng: np.random.Generator,
) -> Float[np.ndarray, "4 4"] | None:
    """T_world_object of an object at rest at a random place; None if it does not come to rest there."""
    offset = rng.uniform(-placement.square_m / 2, placement.square_m / 2, size=2)
    yaw = rng.uniform(-np.pi, np.pi)
    height = table.top_m + model.standing_height_m + placement.drop_height_m
    position = np.array((*(table.centre_m + offset), height))
    world = World(table, physics, model, make_pose(Rotation.from_euler("z", yaw).as_matrix(), position))
    slow_s = 0.0
    for _ in range(round(placement.max_time_s / physics.timestep_s)):
        world.step()
        linear, angular = world.object_speeds
        slow = linear < placement.linear_speed_m_s and angular < placement.angular_speed_rad_s
        slow_s = slow_s + physics.timestep_s if slow else 0.0
        if slow_s >= placement.rest_time_s:
            return world.object_pose if world.object_height_m > table.top_m else None
    return None
