"""The experiment with the gripper: initial rectangles against inference, as a result file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from analysis.evaluation_folder import Evaluation, read_evaluation
from analysis.planning_runs import paired_tests, planner_run
from preshape.files import write_json
from preshape.grasps.space import GraspSpace
from preshape.provenance import provenance


@dataclass(frozen=True, eq=False)
class GripperReport:
    """The report of planners of rectangles.

    Args:
        conditions: folder of the evaluation of each condition.
        subject: the planner that is tested against each of the others.
        output: the result file.
        space: what theta means.
    """

    conditions: Mapping[str, str]
    subject: str
    output: str
    space: GraspSpace

    def write(self) -> str:
        """Write the result file, and say what came out.

        Raises:
            InputError: if an evaluation is missing or cannot be used, or the file cannot be written.
        """
        found = {name: read_evaluation(folder, self.space) for name, folder in self.conditions.items()}
        content = {
            "runs": [
                planner_run(own, name, planner) for name, own in found.items() for planner in own.planners
            ],
            "tests": _tests(found, self.subject, all_scenes=False),
            "tests_of_all_scenes": _tests(found, self.subject, all_scenes=True),
        }
        seed = int(next(iter(found.values())).summary["seed"])
        write_json(self.output, provenance(seed) | content)
        lifted = "; ".join(f"{name}: {own.lifted}" for name, own in found.items())
        return f"Lifted: {lifted}. Result file: {self.output}"


def _tests(found: Mapping[str, Evaluation], subject: str, *, all_scenes: bool) -> list[dict[str, Any]]:
    return [
        test
        for name, own in found.items()
        for test in paired_tests(own, name, subject, all_scenes=all_scenes)
    ]
