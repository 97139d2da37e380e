"""The simulator as the viewer sees it: views of scenes, and recordings of repeated trials."""

import hashlib
import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from hydra.utils import instantiate
from jaxtyping import Float
from omegaconf import DictConfig
from PIL import Image
from trimesh.visual.material import PBRMaterial

from preshape.data.scene import Scene
from preshape.data.trial import Trial
from preshape.perception.segmentation import segment
from preshape.viewer.recording import TrialRecording, read_recording, write_recording
from preshape.viewer.trial_stage import NotExecuted, PlacedHand, SceneLook
from sim.arm.trajectory import MotionFailure
from sim.fingerprint import fingerprint
from sim.laboratory import Laboratory
from sim.objects.actor import ROUGHNESS
from sim.objects.object_model import VisualPart
from sim.repetition import recorded_grasp
from sim.state_recorder import StateRecorder

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class LaboratoryStage:
    """A `preshape.viewer.trial_stage.TrialStage` in a laboratory.

    Args:
        laboratory: where trials take place.
        recordings: folder of what it recorded, which may be deleted at any time. Not to be shared with
            another laboratory.
    """

    laboratory: Laboratory
    recordings: Path

    def look(self, scene: Scene) -> SceneLook:
        """See `TrialStage`."""
        observation = self.laboratory.runner.look(scene)
        return SceneLook(observation, segment(observation, self.laboratory.segmentation))

    def place(self, scene: Scene, theta: Float[np.ndarray, "d"]) -> PlacedHand:
        """See `TrialStage`."""
        runner = self.laboratory.runner
        placed = runner.meaning.place(scene, theta, runner.table, runner.look)
        names = runner.robot.hand_joints
        return PlacedHand(placed.T_world_palm, dict(zip(names, placed.preshape.tolist(), strict=True)))

    def object_mesh(self, object_id: str) -> tuple[trimesh.Trimesh, ...]:
        """See `TrialStage`."""
        return tuple(_mesh(part) for part in self.laboratory.runner.objects.load(object_id).visual_parts)

    def perform(self, scene: Scene, trial: Trial) -> TrialRecording | NotExecuted:
        """See `TrialStage`."""
        path = self.recordings / f"{trial.trial_id}_{_digest(scene, trial)}.npz"
        if path.is_file():
            return read_recording(path)
        runner = self.laboratory.runner
        recorder = StateRecorder(runner.settings.execution.control_period_s)
        grasp = recorded_grasp(trial)
        outcome = runner.run(scene, grasp, recorder).outcome
        if recorder.is_empty:
            placed = runner.meaning.place(scene, trial.planned, runner.table, runner.look)
            model = runner.objects.load(scene.object_id)
            motion = runner.plan_motion(scene, grasp, placed, model)
            assert isinstance(motion, MotionFailure)
            return NotExecuted(outcome, motion.reason)
        recording = recorder.recording(outcome)
        write_recording(path, recording)
        return recording


def configured_stage(laboratory: DictConfig, cache: str) -> LaboratoryStage:
    """The stage of a configured laboratory, which reads no recordings of another one or of other code.

    Args:
        laboratory: as in `conf/laboratory.yaml`.
        cache: folder for derived files.
    """
    name = fingerprint(laboratory, cache=cache)
    return LaboratoryStage(instantiate(laboratory), Path(cache) / "recordings" / name)


def _digest(scene: Scene, trial: Trial) -> str:
    """Different for trials that share a number but not what was tried, as those of two tables."""
    numbers = (scene.T_world_object, scene.camera.T_world_camera, trial.planned)
    text = repr((scene.object_id, trial.seed, [values.tolist() for values in numbers]))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _mesh(part: VisualPart) -> trimesh.Trimesh:
    if part.texture is None or part.uvs is None:
        material = PBRMaterial(
            baseColorFactor=[*part.colour, 1.0], metallicFactor=0.0, roughnessFactor=ROUGHNESS
        )
        uvs = None
    else:
        picture = Image.fromarray(part.texture)
        material = PBRMaterial(baseColorTexture=picture, metallicFactor=0.0, roughnessFactor=ROUGHNESS)
        uvs = part.uvs
    visual = trimesh.visual.TextureVisuals(uv=uvs, material=material)
    return trimesh.Trimesh(
        part.vertices, part.faces, vertex_normals=part.normals, visual=visual, process=False
    )
