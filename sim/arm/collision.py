"""Collision checks of the arm, with its hand in one preshape, against itself, the table and an object."""

from collections.abc import Iterable, Sequence
from itertools import combinations, product

import coal
import numpy as np
import pinocchio as pin
from jaxtyping import Float

from preshape.geometry.pose import invert_pose, transform_points
from sim.arm.kinematics import RobotModel
from sim.table import TableSettings

Pair = tuple[int, int, float]
"""Numbers of two shapes, and the distance (m) at which they count as colliding; negative: a depth allowed."""


class CollisionChecker:
    """Tells whether configurations of the arm are free, for one preshape and one scene.

    Args:
        model: the robot.
        hand: joint angles of the hand (rad).
        table: the table, taken as a solid block on the floor.
        object_parts: vertices of the object's convex parts (m, world).
        clearance_m: distance from the object that `is_clear` asks for.
        allowed_depth_m: how deep the hand may reach into the object before `hand_obstruction` tells.
    """

    def __init__(
        self,
        model: RobotModel,
        hand: Float[np.ndarray, "h"],
        table: TableSettings,
        object_parts: Sequence[Float[np.ndarray, "_ 3"]],
        *,
        clearance_m: float,
        allowed_depth_m: float,
    ) -> None:
        robot = model.robot
        arm, shapes = model.with_frozen_hand(hand)
        moving = [k for k, shape in enumerate(shapes.geometryObjects) if shape.parentJoint > 0]
        hand_shapes = [k for k in moving if _link(arm, shapes, k) in robot.hand_links]
        arm_shapes = [k for k in moving if k not in hand_shapes]
        own = list(_own_pairs(arm, shapes, robot.disabled_pairs))
        T_base_world = invert_pose(robot.T_world_base)
        surroundings = _add_surroundings(shapes, T_base_world, table)
        parts = [_add_part(shapes, transform_points(T_base_world, part)) for part in object_parts]
        hand_fixed = _pairs(hand_shapes, surroundings, 0.0)
        fixed = own + hand_fixed + _pairs(arm_shapes, surroundings, 0.0)
        self._hand = _PairCheck(arm, shapes, hand_fixed + _pairs(hand_shapes, parts, -allowed_depth_m))
        self._arm_and_object = _PairCheck(arm, shapes, _pairs(arm_shapes, parts, 0.0))
        self._fixed = _PairCheck(arm, shapes, fixed)
        self._all = _PairCheck(arm, shapes, fixed + _pairs(moving, parts, clearance_m))

    def hand_obstruction(self, positions: Float[np.ndarray, "a"]) -> str | None:
        """What the hand collides with at this palm pose, however the arm gets it there; None if nothing.

        The hand collides with the object only if it is deep inside.
        """
        return self._hand.first(positions)

    def is_free(self, positions: Float[np.ndarray, "a"]) -> bool:
        """Whether the robot is free of itself, the table and the floor."""
        return not self._fixed(positions)

    def is_free_but_for_hand_on_object(self, positions: Float[np.ndarray, "a"]) -> bool:
        """Whether the robot is free, but that the hand may touch the object."""
        return not (self._fixed(positions) or self._arm_and_object(positions))

    def is_clear(self, positions: Float[np.ndarray, "a"]) -> bool:
        """Whether the robot is free, and well clear of the object."""
        return not self._all(positions)

    def obstruction(self, positions: Float[np.ndarray, "a"]) -> str | None:
        """The first collision that `is_clear` sees, in words; slower."""
        return self._all.first(positions)


class _PairCheck:
    """Checks chosen pairs of shapes."""

    def __init__(self, arm: pin.Model, shapes: pin.GeometryModel, pairs: Iterable[Pair]) -> None:
        self._arm, self._shapes = arm, shapes.copy()
        self._shapes.removeAllCollisionPairs()
        margins = []
        for first, second, margin in pairs:
            self._shapes.addCollisionPair(pin.CollisionPair(first, second))
            margins.append(margin)
        self._arm_data, self._shape_data = arm.createData(), self._shapes.createData()
        for request, margin in zip(self._shape_data.collisionRequests, margins, strict=True):
            request.security_margin = margin
        # Bounding boxes sort out most pairs first, which is three times as fast as asking each.
        self._tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            arm, self._shapes, self._shape_data
        )

    def __call__(self, positions: Float[np.ndarray, "n"]) -> bool:
        """Whether any pair collides."""
        return pin.computeCollisions(self._arm, self._arm_data, self._tree, positions, True)

    def first(self, positions: Float[np.ndarray, "n"]) -> str | None:
        """The names of a pair that collides; slower."""
        pin.computeCollisions(self._arm, self._arm_data, self._shapes, self._shape_data, positions, False)
        for pair, result in zip(self._shapes.collisionPairs, self._shape_data.collisionResults, strict=True):
            if result.isCollision():
                return " and ".join(_link(self._arm, self._shapes, k) for k in (pair.first, pair.second))
        return None


def _pairs(shapes: Iterable[int], others: Iterable[int], margin: float) -> list[Pair]:
    return [(k, other, margin) for k, other in product(shapes, others)]


class HandOverlap:
    """Tells whether the links of a hand overlap each other.

    Args:
        model: the robot.
    """

    def __init__(self, model: RobotModel) -> None:
        self._model = model
        links = [_link(model.whole, model.shapes, k) for k in range(model.shapes.ngeoms)]
        self._check = _PairCheck(
            model.whole,
            model.shapes,
            [
                (i, j, margin)
                for i, j, margin in _own_pairs(model.whole, model.shapes, model.robot.disabled_pairs)
                if {links[i], links[j]} <= set(model.robot.hand_links)
            ],
        )

    def __call__(self, hand: Float[np.ndarray, "h"]) -> str | None:
        """Two links that overlap at these joint angles (rad), in words; None if none do."""
        return self._check.first(self._model.whole_positions(self._model.robot.arm_home, hand))


def _own_pairs(
    model: pin.Model, shapes: pin.GeometryModel, disabled: Iterable[tuple[str, str]]
) -> Iterable[Pair]:
    """Pairs of the robot's own shapes that move against each other and are not meant to overlap."""
    allowed = {frozenset(pair) for pair in disabled}
    joints = [shape.parentJoint for shape in shapes.geometryObjects]
    links = [_link(model, shapes, k) for k in range(shapes.ngeoms)]
    for i, j in combinations(range(shapes.ngeoms), 2):
        if joints[i] != joints[j] and frozenset((links[i], links[j])) not in allowed:
            yield i, j, 0.0


def _link(model: pin.Model, shapes: pin.GeometryModel, k: int) -> str:
    """The link that carries a shape, or the name of a shape that no link carries."""
    shape = shapes.geometryObjects[k]
    return model.frames[shape.parentFrame].name if shape.parentFrame < model.nframes else shape.name


def _add_surroundings(
    shapes: pin.GeometryModel, T_base_world: Float[np.ndarray, "4 4"], table: TableSettings
) -> list[int]:
    block = coal.Box(*table.size_m, table.top_m)
    T_world_block = pin.SE3(np.eye(3), np.array([*table.centre_m, table.top_m / 2]))
    floor = coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    T_base_world = pin.SE3(T_base_world)
    return [
        shapes.addGeometryObject(pin.GeometryObject("table", 0, T_base_world * T_world_block, block)),
        shapes.addGeometryObject(pin.GeometryObject("floor", 0, T_base_world, floor)),
    ]


def _add_part(shapes: pin.GeometryModel, vertices: Float[np.ndarray, "n 3"]) -> int:
    points = coal.StdVec_Vec3s()
    points.extend(list(vertices))
    hull = coal.ConvexBase.convexHull(points, False, None)
    return shapes.addGeometryObject(
        pin.GeometryObject(f"object part {shapes.ngeoms}", 0, pin.SE3.Identity(), hull)
    )
