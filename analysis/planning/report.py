"""The simulation experiment: result file, charts, and a section of the results page."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.chart_files import save_chart
from analysis.evaluation_folder import SUMMARY_FILE, Evaluation, read_evaluation
from analysis.planning.charts import object_figure
from analysis.planning.runs import paired_tests, planner_run
from analysis.planning.tables import object_lines, reliability_lines, round_lines, run_lines, test_lines
from analysis.results_page import put_section
from preshape.errors import InputError
from preshape.evaluation.measured_files import read_figures
from preshape.files import read_json, write_json
from preshape.grasps.space import GraspSpace
from preshape.provenance import provenance

log = logging.getLogger(__name__)

SECTION = "planning"
FIGURES = {"rate": "Success per object", "predicted": "Predicted probability per object"}


@dataclass(frozen=True, eq=False)
class PlanningReport:
    """The report of the planners' comparison.

    Args:
        conditions: folder of the evaluation of each condition; those that are not finished are left out.
        subject: the planner that is tested against each of the others.
        paper_conditions: the same with the paper's network and its planner beside ours.
        paper_subject: the planner that is tested there.
        improvements: result files of `sim/improve.py`; those that are not there are left out.
        output: the result file.
        page: the results page; pictures lie in the folder pictures beside it.
        space: what theta means.
    """

    conditions: Mapping[str, str]
    subject: str
    paper_conditions: Mapping[str, str]
    paper_subject: str
    improvements: Sequence[str]
    output: str
    page: str
    space: GraspSpace

    def write(self) -> str:
        """Write the result file, the charts and the section, and say what came out.

        Raises:
            InputError: if no condition is evaluated, an input cannot be used, or nothing can be written.
        """
        evaluations = _finished(self.conditions, self.space)
        if not evaluations:
            raise InputError(
                "No condition is evaluated yet",
                where=", ".join(self.conditions.values()),
                fix="run `python sim/evaluate.py experiment=planning` first",
            )
        content = {
            **provenance(int(next(iter(evaluations.values())).summary["seed"])),
            **_comparison(evaluations, self.subject),
            "paper_network": _comparison(_finished(self.paper_conditions, self.space), self.paper_subject),
            "rounds": self._rounds(),
        }
        write_json(self.output, content)
        written = read_json(self.output)
        put_section(Path(self.page), SECTION, "\n".join(self._lines(written)))
        lifted = "; ".join(f"{name}: {found.lifted}" for name, found in evaluations.items())
        return f"Lifted: {lifted}. Result file: {self.output}, page: {self.page}"

    def _rounds(self) -> list[dict[str, Any]]:
        found = [
            read_figures(path, "acquisition", "rounds") for path in self.improvements if Path(path).is_file()
        ]
        return [{"acquisition": one["acquisition"], **entry} for one in found for entry in one["rounds"]]

    def _lines(self, content: Mapping[str, Any]) -> list[str]:
        lines = [
            "## Planning",
            "",
            f"Made by `{content['command']}` at revision `{content['git_revision']}`.",
            READING,
            "",
            *self._comparison_lines(content, self.subject, "planning"),
        ]
        if content["paper_network"]["runs"]:
            compared = self._comparison_lines(
                content["paper_network"], self.paper_subject, "planning_paper_network"
            )
            lines += ["", "### With the paper's network", "", PAPER_NETWORK, "", *compared]
        if content["rounds"]:
            lines += ["", "### Learning from its own optima", "", ROUNDS, "", *round_lines(content["rounds"])]
        return lines

    def _comparison_lines(self, compared: Mapping[str, Any], subject: str, pictures: str) -> list[str]:
        """Tables and pictures of the planners that climbed one network, or competed with those that did."""
        runs = compared["runs"]
        lines = [
            *run_lines(runs),
            "",
            f"Exact McNemar tests of `{subject}` against each of the others, differences in percentage "
            "points:",
            "",
            *test_lines(compared["tests"], compared["tests_of_all_scenes"]),
            "",
            RELIABILITY,
            "",
            *reliability_lines(runs),
        ]
        for shown, title in FIGURES.items():
            picture = Path(self.page).parent / "pictures" / f"{pictures}_{shown}.png"
            save_chart(object_figure(runs, shown), picture)
            lines += ["", f"#### {title}", "", f"![{title}](pictures/{picture.name})"]
        for condition in dict.fromkeys(run["condition"] for run in runs):
            own = [run for run in runs if run["condition"] == condition]
            lines += ["", f"Lifted of executed, {condition} (paper):", "", *object_lines(own)]
        return lines


def _finished(conditions: Mapping[str, str], space: GraspSpace) -> dict[str, Evaluation]:
    """The evaluations that are there."""
    found = {}
    for name, folder in conditions.items():
        if (Path(folder) / SUMMARY_FILE).is_file():
            found[name] = read_evaluation(folder, space)
        else:
            log.warning("Condition %s is left out: %s holds no finished evaluation", name, folder)
    return found


def _comparison(evaluations: Mapping[str, Evaluation], subject: str) -> dict[str, Any]:
    """Every planner in every condition, and one planner tested against each of the others."""

    def tests(*, all_scenes: bool) -> list[dict[str, Any]]:
        return [
            test
            for name, found in evaluations.items()
            if subject in found.planners
            for test in paired_tests(found, name, subject, all_scenes=all_scenes)
        ]

    return {
        "conditions": {
            name: {key: found.summary[key] for key in ("command", "git_revision", "date")}
            for name, found in evaluations.items()
        },
        "runs": [
            planner_run(found, name, planner)
            for name, found in evaluations.items()
            for planner in found.planners
        ],
        "tests": tests(all_scenes=False),
        "tests_of_all_scenes": tests(all_scenes=True),
    }


READING = """Seen and unseen are the paper's ten objects, which the network learned from or not; others are
twenty that were drawn at random, which it did not learn from; scans are objects of another kind.
Every planner planned on the same scenes from the same initial grasps. Of `heuristic` every
initial grasp is executed, of the rest the best that the arm can reach: lifted of executed is the
paper's rate. Lifted of all scenes counts a scene without a grasp within reach as a failure; of
`heuristic` one executed grasp a scene counts, drawn by the trial's seed. Intervals are 95 % Wilson;
seconds are those of planning beside other work, without image features."""
RELIABILITY = """How far the probability that planners report at the grasp that was executed is from what
came of it, with its 95 % bootstrap interval; then after corrections that were each fitted to one half of
the scenes and applied to the other:"""
PAPER_NETWORK = """Config-CNN learned from the shipped trials alone, without optima. The paper's planner
(its steps, without a constraint and with ours), its regression network and the others compete on the
scenes of above:"""
ROUNDS = """`python sim/improve.py`: in each round grasps on objects that are not tested are executed and
added to the trials, the network is trained again, and the planners compete again on the same test scenes.
What is added are the planner's own optima, or as a comparison grasps of which the network is least sure
(`acquisition=uncertainty`), or any (`acquisition=uniform`)."""
