"""Evaluation folders as `sim/evaluate.py` writes them (docs/evaluation_folder.md)."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from preshape.data.tables import SCENES_FILE, TRIALS_FILE, read_data_set
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.files import read_json
from preshape.grasps.space import GraspSpace
from preshape.perception.observation import Observation
from preshape.perception.view_choice import load_chosen_view
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.plan_files import read_plan

SUMMARY_FILE = "evaluation.json"
EVALUATE = "python sim/evaluate.py"
AGAIN = f"run `{EVALUATE}` again"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """An evaluation in memory; views, plans and animations are read when they are asked for.

    Args:
        folder: where it lies.
        summary: content of `evaluation.json`.
        scenes, trials: its tables.
    """

    folder: Path
    summary: dict[str, Any]
    scenes: SceneTable
    trials: TrialTable

    @property
    def planners(self) -> dict[str, dict[str, Any]]:
        """Summary of each planner: executed, lifted, rate, low, high, predicted."""
        planners: dict[str, dict[str, Any]] = self.summary["planners"]
        return planners

    @property
    def lifted(self) -> str:
        """`heuristic 5 of 14, inference 9 of 12`."""
        planners = self.planners.items()
        return ", ".join(f"{name} {planner['lifted']} of {planner['executed']}" for name, planner in planners)

    def view(self, scene_id: int) -> Observation:
        """What the camera saw of a scene."""
        return load_chosen_view(self.folder / "views" / str(scene_id))

    def plan(self, scene_id: int, planner: str) -> GraspPlan:
        """What a planner found for a scene."""
        return read_plan(self.folder / "plans" / f"{scene_id}_{planner}.json", self.trials.space)

    def animation(self, trial_id: int) -> Path | None:
        """The film of a trial, if it was filmed."""
        path = self.folder / "animations" / f"{trial_id}.webp"
        return path if path.is_file() else None


def read_evaluation(folder: str | Path, space: GraspSpace) -> Evaluation:
    """Read an evaluation folder.

    Raises:
        InputError: if a file is missing or cannot be used.
    """
    folder = Path(folder)
    if not (folder / SUMMARY_FILE).is_file():
        raise InputError(
            f"The folder holds no finished evaluation: there is no {SUMMARY_FILE}",
            where=folder,
            fix=f"run `{EVALUATE}` first, or give another folder with report.evaluation=DIR",
        )
    summary = read_json(folder / SUMMARY_FILE)
    numbers = ("executed", "lifted", "rate", "low", "high")
    planners = summary.get("planners")
    if not isinstance(planners, dict) or not all(
        isinstance(planner, dict) and set(numbers) <= set(planner) for planner in planners.values()
    ):
        raise InputError(
            f"{SUMMARY_FILE} does not say what the planners lifted",
            where=folder,
            fix=AGAIN,
        )
    scenes, trials = read_data_set(folder, space)
    strangers = set(trials.rows["planner"]) - set(planners)
    if strangers:
        raise InputError(
            f"{TRIALS_FILE} and {SCENES_FILE} are not of the same run as {SUMMARY_FILE}: {sorted(strangers)}",
            where=folder,
            fix=AGAIN,
        )
    return Evaluation(folder, summary, scenes, trials)
