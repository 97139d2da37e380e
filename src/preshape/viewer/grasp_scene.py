"""The three-dimensional scene of the viewer: view, object, grasps and robot, and what of it is shown."""

from collections.abc import Sequence

import numpy as np
import trimesh
from jaxtyping import Float
from viser import GuiCheckboxHandle, SceneNodeHandle, ViserServer

from preshape.drawing.canvas import INITIAL_STYLE, PLANNED_STYLE
from preshape.geometry.pose import quaternion_from_pose
from preshape.perception.observation import Observation
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.recording import TrialRecording
from preshape.viewer.robot_body import RobotBody
from preshape.viewer.robot_figure import RobotFigure
from preshape.viewer.trial_stage import PlacedHand
from preshape.viewer.view_figure import ViewFigure

CONTACT_COLOUR = (213, 0, 90)
CONTACT_M = 0.006
AMBIENT_LIGHT = 2.0
"""Without it, what is turned away from viser's lights is black."""
BYSTANDER_SHIFT = (0.95, 0.05, -0.3)
"""Where the browser's eye is at first, from the camera: to its right and above (m), and nearer to the object,
as a share of the way. The camera is in its picture then."""
BYSTANDER_FOV_RAD = 0.87


class GraspScene:
    """Holds the figures and the switches that show and hide them.

    Args:
        server: the viewer's server.
        jobs: does what the browser asks for.
        body: the robot.
        executes: whether trials are executed here, so that there are an arm and an object to show.

    Attributes:
        view, initial, planned, robot: the figures; no robot where nothing is executed.
        switches: whether each is shown, by the name in the panel.
    """

    def __init__(self, server: ViserServer, jobs: JobQueue, body: RobotBody, *, executes: bool) -> None:
        self._server, self._executes = server, executes
        robot, scene = body.robot, server.scene
        scene.set_up_direction("+z")
        scene.configure_environment_map(None)  # viser would fetch one from the internet
        scene.configure_default_lights(cast_shadow=False)  # points catch none
        scene.add_light_ambient("/light", intensity=AMBIENT_LIGHT)
        self.view = ViewFigure(scene)
        self.initial = RobotFigure(scene, "/initial", body, robot.hand_links, INITIAL_STYLE.colour, 0.45)
        self.planned = RobotFigure(scene, "/planned", body, robot.hand_links, PLANNED_STYLE.colour)
        self._robot_links = (*robot.arm_links, *robot.hand_links)
        self.robot = RobotFigure(scene, "/robot", body, self._robot_links) if executes else None
        self._base = robot.T_world_base
        self._object = scene.add_frame("/object", show_axes=False, visible=False)
        self._contacts = scene.add_frame("/contacts", show_axes=False, visible=False)
        self._distinct = False
        self._stands = False
        self.switches: dict[str, GuiCheckboxHandle] = {}
        self._add_switches(jobs)

    def show_view(self, observation: Observation) -> None:
        """Show what the camera sees."""
        self.view.show(observation)
        self.refresh()

    def look_at(self, T_world_camera: Float[np.ndarray, "4 4"], target: Float[np.ndarray, "3"]) -> None:
        """Where browsers that connect later look from: beside the camera, at a point of the world (m)."""
        toward = target - T_world_camera[:3, 3]
        right, up = T_world_camera[:3, 0], np.array([0.0, 0.0, 1.0])
        sideways, upwards, nearer = BYSTANDER_SHIFT
        eye = T_world_camera[:3, 3] + sideways * right + upwards * up + nearer * toward
        self._server.initial_camera.position = tuple(eye)
        self._server.initial_camera.look_at = tuple(target)
        self._server.initial_camera.fov = BYSTANDER_FOV_RAD

    def show_object(self, meshes: Sequence[trimesh.Trimesh], pose: Float[np.ndarray, "4 4"]) -> None:
        """Put another object into the scene."""
        self._object.remove()
        self._object = self._server.scene.add_frame("/object", show_axes=False, visible=False)
        for number, mesh in enumerate(meshes):
            self._server.scene.add_mesh_trimesh(f"/object/part_{number}", mesh)
        _put(self._object, pose)
        self.refresh()

    def show_initial(self, hand: PlacedHand) -> None:
        """Put the hand of the initial grasp."""
        self.initial.put_palm(hand.T_world_palm, hand.joints)

    def show_planned(self, hand: PlacedHand, *, distinct: bool) -> None:
        """Put the hand of the planned grasp.

        Args:
            hand: where.
            distinct: whether it is another one than the initial grasp, which would hide it.
        """
        self.planned.put_palm(hand.T_world_palm, hand.joints)
        self._distinct = distinct
        self.refresh()

    def show_state(self, recording: TrialRecording, instant: int) -> None:
        """Put robot and object where they were, with the points where they touched."""
        if self.robot is None:
            return
        self.robot.put(self._base, recording.joints_at(instant))
        _put(self._object, recording.T_world_object[instant])
        points, _ = recording.contacts_at(instant)
        self._server.scene.add_point_cloud(
            "/contacts/points",
            points.astype(np.float32),
            CONTACT_COLOUR,
            point_size=CONTACT_M,
            point_shape="circle",
            precision="float32",
        )

    def show_robot(self, stands: bool) -> None:
        """Whether the robot has been put somewhere.

        Then it is shown with the object that moves, and the hands of the grasps are not.
        """
        self._stands = stands
        set_value(self.switches["object's true shape"], stands)
        set_value(self.switches["initial grasp (orange)"], not stands)
        set_value(self.switches["planned grasp (blue)"], not stands)
        self.refresh()

    def refresh(self) -> None:
        """Show what the switches say."""
        on = {name: switch.value for name, switch in self.switches.items()}
        for name, node in (("point cloud", self.view.cloud), ("camera", self.view.camera)):
            if node is not None:
                node.visible = on[name]
        self.initial.visible = on["initial grasp (orange)"]
        self.planned.visible = on["planned grasp (blue)"] and self._distinct
        if self.robot is not None:
            self.robot.visible = self._contacts.visible = on["robot"] and self._stands
            self._object.visible = on["object's true shape"]

    def _add_switches(self, jobs: JobQueue) -> None:
        names = ["point cloud", "camera", "initial grasp (orange)", "planned grasp (blue)"]
        names += ["robot", "object's true shape"] if self._executes else []
        for name in names:
            self.switches[name] = self._server.gui.add_checkbox(name, name != "object's true shape")
            self.switches[name].on_update(lambda _: jobs.put(self.refresh))


def _put(node: SceneNodeHandle, pose: Float[np.ndarray, "4 4"]) -> None:
    node.wxyz = quaternion_from_pose(pose)
    node.position = pose[:3, 3]
