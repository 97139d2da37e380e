"""The experiment with the gripper: initial rectangles against inference, as result file and tables."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.evaluation_folder import Evaluation, read_evaluation
from analysis.paper_figures import ALL, paper_number
from analysis.planning.runs import paired_tests, planner_run
from analysis.planning.tables import object_lines, reliability_lines, run_lines, test_lines
from analysis.results_page import put_section
from preshape.files import write_json
from preshape.grasps.space import GraspSpace
from preshape.provenance import provenance

SECTION = "two_finger"
PAPER_CONDITION = "two_finger"


@dataclass(frozen=True, eq=False)
class GripperReport:
    """The report of planners of rectangles.

    Args:
        conditions: folder of the evaluation of each condition.
        subject: the planner that is tested against each of the others.
        output: the result file.
        page: Markdown file of which the section `two_finger` is written.
        space: what theta means.
    """

    conditions: Mapping[str, str]
    subject: str
    output: str
    page: str
    space: GraspSpace

    def write(self) -> str:
        """Write result file and section, and say what came out.

        Raises:
            InputError: if an evaluation is missing or cannot be used, or a file cannot be written.
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
        put_section(Path(self.page), SECTION, "\n".join(_lines(content, self.subject)))
        lifted = "; ".join(f"{name}: {own.lifted}" for name, own in found.items())
        return f"Lifted: {lifted}. Result file: {self.output}, page: {self.page}"


def _lines(content: Mapping[str, Any], subject: str) -> list[str]:
    initial, inferred = (paper_number(PAPER_CONDITION, name, ALL) for name in ("heuristic", "inference"))
    lines = [
        "## Two fingers: rectangles executed",
        "",
        "`results/two_finger.json`, made by `python sim/evaluate.py experiment=two_finger` and "
        "`python analysis/report.py report=gripper robot=baxter`. All planners have the same scenes and the "
        "same four initial rectangles; `Heuristic` is these, all executed. Intervals are 95 % Wilson.",
        f"The paper, on a real robot: initial rectangles {100 * (initial.rate or 0):.0f} %, predicted "
        f"{initial.predicted}; inference {100 * (inferred.rate or 0):.0f} %, predicted {inferred.predicted}.",
        "",
        *run_lines(content["runs"]),
        "",
        f"Exact McNemar tests of `{subject}` against each of the others, differences in percentage points:",
        "",
        *test_lines(content["tests"], content["tests_of_all_scenes"]),
        "",
        *reliability_lines(content["runs"]),
    ]
    for condition in dict.fromkeys(run["condition"] for run in content["runs"]):
        runs = [run for run in content["runs"] if run["condition"] == condition]
        lines += ["", f"Lifted of executed, per object of `{condition}`:", "", *object_lines(runs)]
    return lines


def _tests(found: Mapping[str, Evaluation], subject: str, *, all_scenes: bool) -> list[dict[str, Any]]:
    return [
        test
        for name, own in found.items()
        for test in paired_tests(own, name, subject, all_scenes=all_scenes)
    ]
