"""A trial from its planned grasp to its label."""

import time
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from preshape.data.scene import Scene, SceneRenderer
from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.geometry.pose import make_pose, transform_points
from sim.arm.planner import ArmPlanner
from sim.arm.trajectory import GraspMotion, MotionFailure
from sim.execution import Execution, ExecutionSettings, GraspExecutor, Spectator
from sim.grasp_meaning import GraspMeaning, PlacedGrasp
from sim.objects.object_model import ObjectModel, ObjectSet
from sim.outcome import OutcomeSettings, judge
from sim.physics import PhysicsSettings
from sim.robots.description import RobotDescription
from sim.table import TableSettings
from sim.world import World

DISTURBANCE_STREAM = 2
"""Keeps the random numbers of the repetitions apart from those of the motion's planning, of the same seed."""


@dataclass(frozen=True, eq=False)
class PlannedGrasp:
    """A grasp that someone wants tried.

    Args:
        trial_id: number of the trial; with the run's seed it decides everything random in it.
        planner: who planned it.
        face: face that the initial grasp aimed at; decides how the hand closes.
        initial, planned: theta before and after planning.
        success_prob: predicted for `planned`; NaN if nothing was predicted.
        seed: seed of the trial.
        planning_s: seconds that planning the grasp itself took.
    """

    trial_id: int
    planner: str
    face: Face
    initial: Float[np.ndarray, "d"]
    planned: Float[np.ndarray, "d"]
    success_prob: float
    seed: int
    planning_s: float = 0.0

    def untried(self, scene: Scene, outcome: TrialOutcome) -> Trial:
        """The row of this grasp as long as the robot has not tried it."""
        return Trial(
            trial_id=self.trial_id,
            scene_id=scene.scene_id,
            object_id=scene.object_id,
            planner=self.planner,
            face=self.face,
            initial=self.initial,
            planned=self.planned,
            reached=np.full_like(self.planned, np.nan),
            outcome=outcome,
            lift_height_m=float("nan"),
            success_prob=self.success_prob,
            seed=self.seed,
            scene_s=0.0,
            planning_s=self.planning_s,
            physics_s=0.0,
            rendering_s=0.0,
        )


@dataclass(frozen=True)
class DisturbanceSettings:
    """Repetitions of a trial with the object a little beside where the robot believes it to be.

    The share of them that ends LIFTED is the trial's soft label: how sure the grasp is.

    Args:
        repeats: number of repetitions; 0 for no soft label.
        position_m: standard deviation of the object's shift along both horizontal axes.
        yaw_rad: standard deviation of its turn about the vertical.
    """

    repeats: int = 0
    position_m: float = 0.003
    yaw_rad: float = 0.03


@dataclass(frozen=True)
class TrialSettings:
    """Everything that decides a trial's labels beside the grasp."""

    physics: PhysicsSettings = field(default_factory=PhysicsSettings)
    execution: ExecutionSettings = field(default_factory=ExecutionSettings)
    outcome: OutcomeSettings = field(default_factory=OutcomeSettings)
    disturbances: DisturbanceSettings = field(default_factory=DisturbanceSettings)


@dataclass(frozen=True, eq=False)
class TrialRunner:
    """Tries grasps, each in a fresh world.

    Args:
        robot: who grasps.
        objects, table: what there is to grasp.
        arm: plans the arm's motions.
        settings: physics, controller and label.
        meaning: what theta means to the robot.
        look: the view of a scene, where the meaning depends on it.
    """

    robot: RobotDescription
    objects: ObjectSet
    table: TableSettings
    arm: ArmPlanner
    settings: TrialSettings
    meaning: GraspMeaning
    look: SceneRenderer

    def run(self, scene: Scene, grasp: PlannedGrasp, spectator: Spectator | None = None) -> Trial:
        """Try one grasp; the same scene and grasp give the same trial to the bit, timings aside."""
        model = self.objects.load(scene.object_id)
        start = time.perf_counter()
        placed = self.meaning.place(scene, grasp.planned, self.table, self.look)
        motion = self.plan_motion(scene, grasp, placed, model)
        planned = time.perf_counter()
        if isinstance(motion, MotionFailure):
            return self._row(scene, grasp, motion.outcome, planning_s=planned - start)
        world = self._world(model, scene.T_world_object, rendered=spectator is not None)
        built = time.perf_counter()
        execution = self._execute(world, motion, grasp, placed, spectator)
        done = time.perf_counter()
        outcome = judge(execution.measured, self.settings.outcome)
        times = {"planning_s": planned - start, "scene_s": built - planned, "physics_s": done - built}
        trial = replace(
            self._row(scene, grasp, outcome, **times),
            reached=placed.theta_of(execution.T_world_palm, execution.hand),
            lift_height_m=execution.measured.final_height_m,
        )
        return replace(trial, soft_label=self._soft_label(scene, grasp, placed, motion, model))

    def plan_motion(
        self, scene: Scene, grasp: PlannedGrasp, placed: PlacedGrasp, model: ObjectModel
    ) -> GraspMotion | MotionFailure:
        """The arm's motion to a planned grasp, or why there is none."""
        parts = tuple(transform_points(scene.T_world_object, part) for part in model.collision_parts)
        rng = np.random.default_rng(grasp.seed)
        return self.arm.plan_grasp(placed.T_world_palm, placed.preshape, parts, rng)

    def _world(self, model: ObjectModel, pose: Float[np.ndarray, "4 4"], *, rendered: bool = False) -> World:
        world = World(self.table, self.settings.physics, model, pose, rendered=rendered)
        return world.with_robot(self.robot)

    def _execute(
        self,
        world: World,
        motion: GraspMotion,
        grasp: PlannedGrasp,
        placed: PlacedGrasp,
        spectator: Spectator | None = None,
    ) -> Execution:
        executor = GraspExecutor(world, self.settings.physics, self.settings.execution, spectator)
        return executor.execute(motion, placed.preshape, grasp.face.grasp_type)

    def _soft_label(
        self, scene: Scene, grasp: PlannedGrasp, placed: PlacedGrasp, motion: GraspMotion, model: ObjectModel
    ) -> float:
        """Share of the repetitions that end LIFTED; NaN if there are none."""
        settings = self.settings.disturbances
        rng = np.random.default_rng([grasp.seed, DISTURBANCE_STREAM])
        lifted = []
        for _ in range(settings.repeats):
            pose = _disturbed(scene.T_world_object, settings, rng)
            execution = self._execute(self._world(model, pose), motion, grasp, placed)
            lifted.append(judge(execution.measured, self.settings.outcome) is TrialOutcome.LIFTED)
        return float(np.mean(lifted)) if lifted else float("nan")

    def _row(
        self,
        scene: Scene,
        grasp: PlannedGrasp,
        outcome: TrialOutcome,
        *,
        planning_s: float,
        scene_s: float = 0.0,
        physics_s: float = 0.0,
    ) -> Trial:
        row = grasp.untried(scene, outcome)
        planning_s += row.planning_s
        return replace(row, scene_s=scene_s, planning_s=planning_s, physics_s=physics_s)


def _disturbed(
    pose: Float[np.ndarray, "4 4"], settings: DisturbanceSettings, rng: np.random.Generator
) -> Float[np.ndarray, "4 4"]:
    """The pose shifted and turned on the table about the object's own origin."""
    turn = Rotation.from_euler("z", rng.normal(0.0, settings.yaw_rad)).as_matrix()
    shift = np.append(rng.normal(0.0, settings.position_m, size=2), 0.0)
    return make_pose(turn @ pose[:3, :3], pose[:3, 3] + shift)
