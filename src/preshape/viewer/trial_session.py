"""The viewer of a table's trials: chooses them, plans from them, and executes them."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from viser import ViserServer

from preshape.data.scene import Scene
from preshape.data.trial import Trial
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.geometry.pose import transform_points
from preshape.grasps.heuristic import InitialGrasp
from preshape.planning.grasp_planner import GraspPlanner
from preshape.viewer.climb_panel import NO_PLAN, ClimbPanel
from preshape.viewer.grasp_scene import GraspScene
from preshape.viewer.input_values import set_value
from preshape.viewer.job_queue import JobQueue
from preshape.viewer.replay_panel import ReplayPanel
from preshape.viewer.robot_body import Robot, RobotBody
from preshape.viewer.trial_choice import FirstTrial
from preshape.viewer.trial_panel import TrialPanel
from preshape.viewer.trial_stage import NotExecuted, TrialStage
from preshape.viewer.trial_story import MEANING

EVERYTHING = FirstTrial()
NO_PLANNER = "The viewer has no planner for the grasps of this robot: they are rectangles, not palm poses."

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class TrialParts:
    """What a session of trials works with.

    Args:
        robot: who grasps.
        scenes, trials: the tables.
        stage: shows the scenes and repeats the trials.
        planner: climbs from the recorded grasps; None where nothing is known about success.
    """

    robot: Robot
    scenes: SceneTable
    trials: TrialTable
    stage: TrialStage
    planner: GraspPlanner | None


class TrialSession:
    """Shows one trial of a table at a time.

    Args:
        server: the viewer's server.
        jobs: does what the browser asks for.
        parts: what to work with.
        first: what is shown first.

    Raises:
        InputError: if the table has no such trial.
    """

    def __init__(
        self, server: ViserServer, jobs: JobQueue, parts: TrialParts, first: FirstTrial = EVERYTHING
    ) -> None:
        self._parts = parts
        self._status = server.gui.add_markdown("Starting")
        self.trials = TrialPanel(server.gui, jobs, parts.trials, self.show_trial)
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Climb"):
            without = NO_PLAN if parts.planner else NO_PLANNER
            self.climb = ClimbPanel(server.gui, jobs, self._show_grasp, from_the_end=False, without=without)
        with tabs.add_tab("Execution"):
            self.repeat = server.gui.add_button("repeat the recorded grasp")
            self.execute = server.gui.add_button(
                "execute the grasp of the climb", visible=bool(parts.planner)
            )
            self.replay = ReplayPanel(server.gui, jobs, self._show_state)
        self.repeat.on_click(lambda _: jobs.put(self.perform_recorded))
        self.execute.on_click(lambda _: jobs.put(self.perform_planned))
        with tabs.add_tab("Show"):
            self.scene = GraspScene(server, jobs, RobotBody(parts.robot), executes=True)
        self.trials.choose(first)

    def tick(self) -> None:
        """Go on playing."""
        self.replay.tick()

    def show_trial(self) -> None:
        """Show the chosen trial: its scene, its grasp, its label, and what the planner makes of it."""
        trial = self.trials.trial
        if trial is None:
            self._status.content = "No trial of the table is of this object and ended so."
            return
        self.replay.clear()
        self.climb.show(None)
        self._say(f"Looking at trial {trial.trial_id}", lambda: self._look_and_plan(trial))

    def perform_recorded(self) -> None:
        """Repeat the trial in the simulator."""
        if (trial := self.trials.trial) is not None:
            self._perform(trial, "the recorded grasp")

    def perform_planned(self) -> None:
        """Execute the grasp at which the climb's slider stands."""
        trial, theta = self.trials.trial, self.climb.theta
        if trial is not None and theta is not None:
            name = f"the grasp of step {self.climb.step.value}, p(success) {self.climb.success_prob:.2f}"
            self._perform(replace(trial, planned=theta), name)

    def _look_and_plan(self, trial: Trial) -> None:
        parts, scene = self._parts, self._parts.scenes.by_id[trial.scene_id]
        self.scene.show_object(parts.stage.object_mesh(trial.object_id), scene.T_world_object)
        self.scene.show_initial(parts.stage.place(scene, trial.planned))
        self.scene.show_planned(parts.stage.place(scene, trial.planned), distinct=False)
        self.scene.show_robot(False)
        look = parts.stage.look(scene)
        self.scene.show_view(look.observation)
        centre = look.segmented.T_camera_box[:3, 3]
        T_world_camera = scene.camera.T_world_camera
        self.scene.look_at(T_world_camera, transform_points(T_world_camera, centre[None])[0])
        if parts.planner is not None:
            start = InitialGrasp(trial.planned, trial.face)
            self.climb.show(parts.planner.plan_from(look.observation, look.segmented, [start]))
        self.trials.describe(trial, self.climb.success_prob)

    def _perform(self, trial: Trial, name: str) -> None:
        scene = self._parts.scenes.by_id[trial.scene_id]
        what = f"Executing {name} of trial {trial.trial_id}"
        self._say(what, lambda: self._play(scene, trial, name))

    def _play(self, scene: Scene, trial: Trial, name: str) -> None:
        came_of_it = self._parts.stage.perform(scene, trial)
        if isinstance(came_of_it, NotExecuted):
            outcome = came_of_it.outcome
            ended = f"**{outcome.value.upper()}**: {MEANING[outcome]}"
            self.replay.clear(f"**{name.capitalize()}**\n\n{ended}\n\n- {came_of_it.reason}")
            return
        self.replay.show(came_of_it, name)
        self.scene.show_robot(True)
        set_value(self.replay.playing, True)

    def _show_grasp(self) -> None:
        trial, theta = self.trials.trial, self.climb.theta
        if trial is None or theta is None:
            return
        scene = self._parts.scenes.by_id[trial.scene_id]
        distinct = not np.array_equal(theta, trial.planned)
        self.scene.show_planned(self._parts.stage.place(scene, theta), distinct=distinct)

    def _show_state(self) -> None:
        if self.replay.recording is not None:
            self.scene.show_state(self.replay.recording, self.replay.instant.value)

    def _say(self, what: str, work: Callable[[], None]) -> None:
        """Tell the browser and the terminal what is being done, and what went wrong with it."""
        self._status.content = f"{what} ..."
        log.info("%s", what)
        try:
            work()
            self._status.content = f"{what}: done."
        except InputError as error:
            log.warning("%s", error)
            self._status.content = f"**{error.what}**\n\nwhere: {error.where}\n\nfix: {error.fix}"
