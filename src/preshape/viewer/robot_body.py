"""What a robot looks like at any joint positions."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import coal
import numpy as np
import pinocchio as pin
import trimesh
from jaxtyping import Float

from preshape.errors import InputError
from preshape.geometry.pose import invert_pose


@runtime_checkable
class Robot(Protocol):
    """What the viewer asks of a robot: `sim.robots.description.RobotDescription` has it.

    Attributes:
        urdf_path: arm and hand in one file; meshes by absolute path.
        hand_joints: the hand's joints by name.
        arm_links, hand_links: links by name.
        palm_link: the link that carries the palm frame.
        T_link_palm: palm frame in the palm link.
        T_world_base: pose of the URDF's root link.
    """

    urdf_path: Path
    hand_joints: tuple[str, ...]
    arm_links: tuple[str, ...]
    hand_links: tuple[str, ...]
    palm_link: str
    T_link_palm: Float[np.ndarray, "4 4"]
    T_world_base: Float[np.ndarray, "4 4"]

    def preshape(self, joints: Float[np.ndarray, "j"]) -> Float[np.ndarray, "h"]:
        """All joint positions of the hand (rad or m) for the preshape joints of theta."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A rigid part of a robot.

    Args:
        name: unique among the robot's shapes.
        link: the link that it belongs to.
        mesh: its surface (m), in its own frame.
        colour: RGB, 0-255.
    """

    name: str
    link: str
    mesh: trimesh.Trimesh
    colour: tuple[int, int, int]


class RobotBody:
    """The visible shapes of a robot and where they are.

    Args:
        robot: the robot.

    Raises:
        InputError: if its URDF or a mesh of it cannot be read.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        path = str(robot.urdf_path)
        try:
            self._model = pin.buildModelFromUrdf(path)
            self._geometry = pin.buildGeomFromUrdf(self._model, path, pin.GeometryType.VISUAL)
        except ValueError as error:
            raise InputError(
                f"The robot's URDF or a mesh of it cannot be read ({error})",
                where=robot.urdf_path,
                fix="delete the file, which is derived, and start again",
            ) from error
        self._data, self._placements = self._model.createData(), self._geometry.createData()
        self.shapes = tuple(
            Shape(part.name, self._model.frames[part.parentFrame].name, _mesh(part), _colour(part))
            for part in self._geometry.geometryObjects
        )

    def shapes_of(self, links: Iterable[str]) -> tuple[Shape, ...]:
        """The shapes of some links."""
        wanted = set(links)
        return tuple(shape for shape in self.shapes if shape.link in wanted)

    def poses(self, joints: Mapping[str, float]) -> dict[str, Float[np.ndarray, "4 4"]]:
        """Pose of each shape in the robot's root link, by the shape's name.

        Args:
            joints: joint positions (rad or m) by name; others are at zero.
        """
        positions = self._positions(joints)
        pin.updateGeometryPlacements(self._model, self._data, self._geometry, self._placements, positions)
        placed = zip(self.shapes, self._placements.oMg, strict=True)
        return {shape.name: pose.homogeneous for shape, pose in placed}

    def base_pose(
        self, T_world_palm: Float[np.ndarray, "4 4"], joints: Mapping[str, float]
    ) -> Float[np.ndarray, "4 4"]:
        """Where the root link would have to be for the palm to be at a pose."""
        pin.framesForwardKinematics(self._model, self._data, self._positions(joints))
        T_base_link = self._data.oMf[self._model.getFrameId(self.robot.palm_link)].homogeneous
        pose: Float[np.ndarray, "4 4"] = T_world_palm @ invert_pose(T_base_link @ self.robot.T_link_palm)
        return pose

    def _positions(self, joints: Mapping[str, float]) -> Float[np.ndarray, "q"]:
        positions: Float[np.ndarray, "q"] = pin.neutral(self._model)
        for name, position in joints.items():
            positions[self._model.joints[self._model.getJointId(name)].idx_q] = position
        return positions


def _mesh(part: pin.GeometryObject) -> trimesh.Trimesh:
    shape = part.geometry
    mesh: trimesh.Trimesh
    if isinstance(shape, coal.Sphere):
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=shape.radius)
    elif isinstance(shape, coal.Cylinder):
        mesh = trimesh.creation.cylinder(radius=shape.radius, height=2 * shape.halfLength)
    elif isinstance(shape, coal.Box):
        mesh = trimesh.creation.box(2 * shape.halfSide)
    else:
        # Pinocchio has read the file, whatever its format; coal's triangles can only be asked for by index.
        triangles = [shape.tri_indices(k) for k in range(shape.num_tris)]
        faces = np.array([[triangle[corner] for corner in range(3)] for triangle in triangles])
        mesh = trimesh.Trimesh(np.array(shape.vertices()), faces)
    return mesh


def _colour(part: pin.GeometryObject) -> tuple[int, int, int]:
    red, green, blue = (round(255 * float(value)) for value in part.meshColor[:3])
    return red, green, blue
