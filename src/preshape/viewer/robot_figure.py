"""A robot, or a part of it, in the viewer's scene."""

from collections.abc import Iterable, Mapping

import numpy as np
from jaxtyping import Float
from viser import MeshHandle, SceneApi

from preshape.geometry.pose import quaternion_from_pose
from preshape.viewer.robot_body import RobotBody


class RobotFigure:
    """Meshes that move together.

    Args:
        scene: the viewer's scene.
        name: of its node; the node of each shape is below it.
        body: what it looks like.
        links: links that are shown.
        colour: RGB, 0-255; None for the robot's own.
        opacity: 1 for solid.

    Attributes:
        nodes: the meshes by the names of their shapes; their poses are in the world.
    """

    def __init__(
        self,
        scene: SceneApi,
        name: str,
        body: RobotBody,
        links: Iterable[str],
        colour: tuple[int, int, int] | None = None,
        opacity: float = 1.0,
    ) -> None:
        self._body = body
        self._root = scene.add_frame(name, show_axes=False, visible=False)
        self.nodes: dict[str, MeshHandle] = {
            shape.name: scene.add_mesh_simple(
                f"{name}/{shape.name}",
                np.asarray(shape.mesh.vertices),
                np.asarray(shape.mesh.faces),
                color=colour or shape.colour,
                opacity=None if opacity == 1.0 else opacity,
                side="double" if opacity == 1.0 else "front",
            )
            for shape in body.shapes_of(links)
        }

    @property
    def visible(self) -> bool:
        """Whether it is shown."""
        return self._root.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._root.visible = visible

    def put(self, T_world_base: Float[np.ndarray, "4 4"], joints: Mapping[str, float]) -> None:
        """Put the robot's root link at a pose and its joints at positions (rad or m)."""
        for name, pose in self._body.poses(joints).items():
            if name in self.nodes:
                place(self.nodes[name], T_world_base @ pose)

    def put_palm(self, T_world_palm: Float[np.ndarray, "4 4"], joints: Mapping[str, float]) -> None:
        """Put the palm frame at a pose."""
        self.put(self._body.base_pose(T_world_palm, joints), joints)


def place(node: MeshHandle, T_world_node: Float[np.ndarray, "4 4"]) -> None:
    """Move a node of the scene's root to a pose."""
    node.wxyz = quaternion_from_pose(T_world_node)
    node.position = T_world_node[:3, 3]
