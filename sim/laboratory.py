"""The simulated laboratory: everything that collecting and evaluating share."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from preshape.data.scene import Scene, SceneRenderer
from preshape.data.trial_table import TableOrigin
from preshape.grasps.heuristic import InitialGrasp
from preshape.grasps.space import GraspSpace
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, SegmentedObject, segment
from sim.grasp_proposals import GraspProposals
from sim.scene_maker import SceneMaker
from sim.trial import TrialRunner


@dataclass(frozen=True, eq=False)
class SceneView:
    """What the robot sees of a scene, and where planning starts.

    Args:
        observation: the RGB-D view.
        segmented: the object in it.
        initial: initial grasps.
    """

    observation: Observation
    segmented: SegmentedObject
    initial: tuple[InitialGrasp, ...]


@dataclass(frozen=True, eq=False)
class Laboratory:
    """Makes scenes, looks at them and tries grasps on them.

    Args:
        origin: names of the robot, the objects and the camera, for the tables.
        space: what theta means.
        scenes: makes scenes.
        renderer: makes their images.
        proposals: which grasps are tried.
        runner: tries grasps.
        segmentation: how the robot finds the object.
    """

    origin: TableOrigin
    space: GraspSpace
    scenes: SceneMaker
    renderer: SceneRenderer
    proposals: GraspProposals
    runner: TrialRunner
    segmentation: SegmentationSettings = field(default_factory=SegmentationSettings)

    def view(self, scene: Scene) -> SceneView:
        """Look at a scene; the same scene gives the same view.

        Raises:
            InputError: if no object can be made out in the view.
        """
        observation = self.renderer(scene)
        segmented = segment(observation, self.segmentation)
        rng = np.random.default_rng([scene.seed, GRASP_STREAM])
        grasps = self.proposals.initial(segmented, scene.camera, rng)
        return SceneView(observation, segmented, tuple(grasps))

    def explored(self, scene: Scene, view: SceneView) -> list[InitialGrasp]:
        """Grasps that stray from the initial ones; the same scene gives the same grasps."""
        rng = np.random.default_rng([scene.seed, EXPLORATION_STREAM])
        return self.proposals.strayed(view.segmented, scene.camera, rng)

    @property
    def grasps_per_scene(self) -> int:
        """Most grasps that collecting tries on a scene."""
        return self.proposals.most


GRASP_STREAM, EXPLORATION_STREAM = 1, 2
"""Keep the random numbers of grasps apart from the sensor's, which start from the same seed."""

LaboratoryFactory = Callable[[], Laboratory]
"""Builds the laboratory; each worker process builds its own."""


def trial_seed(run_seed: int, scene_id: int, grasp: int) -> int:
    """Seed of the trial of one initial grasp of one scene, for whichever planner tries it."""
    digest = hashlib.sha256(f"{run_seed}/{scene_id}/{grasp}".encode()).digest()
    return int.from_bytes(digest[:8], "big") >> 1
