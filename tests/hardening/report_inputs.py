"""Every file that a report reads."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from preshape.paths import project_root

REPORT = "analysis/report.py"
RESULTS = project_root() / "results"
CORNELL_FILES = (
    *("01/pcd0100r.png", "01/pcd0101d.tiff", "01/pcd0100.txt", "01/pcd0102cpos.txt"),
    "processedData/z.txt",
)
"""Colour, range image, measured points, rectangles, objects."""
EVALUATION_FILES = ("evaluation.json", "trials.parquet", "plans/0_inference.json", "views/0/camera.json")


@dataclass(frozen=True)
class Input:
    """Something that a command reads.

    Args:
        command: the script.
        arguments: the rest of its command line.
        setting: which names the file or folder.
        good: a good one.
        damaged: the file below it that is to be damaged; None for the folder's largest, or the file itself.
        value: how the setting names it.
        may_do: whether damage may go unnoticed, since the file is shown as it is, or left out.
    """

    command: str
    arguments: tuple[str, ...]
    setting: str
    good: Path
    damaged: str | None = None
    value: str = "{}"
    may_do: bool = False

    def argument(self, path: Path) -> str:
        """The setting that names a path."""
        return f"{self.setting}={self.value.format(path)}"


class Reports:
    """What reports read.

    Args:
        arguments: makes the command line of a report that writes where it may.
        inputs: folder of `make_inputs`.
    """

    def __init__(self, arguments: Callable[..., tuple[str, ...]], inputs: Path) -> None:
        self._arguments, self._inputs = arguments, inputs

    def __iter__(self) -> Iterator[Input]:
        yield from self._of_evaluations()
        yield from self._of_data()
        yield from self._of_results()
        yield from self._of_trainings()
        yield from self._of_cornell()

    def _of_evaluations(self) -> Iterator[Input]:
        evaluation, metrics = self._inputs / "evaluation", self._inputs / "metrics.json"
        both = {"metrics": metrics, "evaluation": evaluation}
        demo = self._arguments("demo", **both, max_scenes=1)
        yield Input(REPORT, demo, "report.evaluation", evaluation, may_do=True)  # the largest is a film
        for file in EVALUATION_FILES:
            yield Input(REPORT, demo, "report.evaluation", evaluation, file)
        yield Input(REPORT, demo, "report.metrics", metrics)
        first = self._arguments("first_pass", data=self._inputs / "table", **both)
        yield Input(REPORT, first, "report.evaluation", evaluation, "trials.parquet")
        gripper = self._arguments("gripper")
        yield Input(REPORT, gripper, "report.conditions.fitting", evaluation, "trials.parquet")
        planning = self._arguments("planning")
        seen = f"report.conditions.seen={evaluation}"
        yield Input(REPORT, planning, "report.conditions.seen", evaluation, "trials.parquet")
        rounds = self._inputs / "improvement.json"
        yield Input(REPORT, (*planning, seen), "report.improvements", rounds, value="[{}]", may_do=True)

    def _of_data(self) -> Iterator[Input]:
        table, families = self._inputs / "table", self._inputs / "grocery.csv"
        given = {"data": table, "families": families, "sensitivity": "null", "label_check": "null"}
        data = self._arguments("dataset", **given)
        yield Input(REPORT, data, "report.data", table)
        yield Input(REPORT, data, "report.families", families, may_do=True)  # a shorter list is one, too
        for key in ("sensitivity", "label_check"):
            yield Input(REPORT, data, f"report.{key}", RESULTS / f"{key}.json")
        yield Input(REPORT, self._arguments("objects", data=table), "report.data", table)

    def _of_results(self) -> Iterator[Input]:
        collection = self._arguments("collection", effort=self._inputs / "effort.json")
        yield Input(REPORT, collection, "report.effort", self._inputs / "effort.json")
        for key in ("dataset", "crash_test", "sensitivity", "label_check"):
            yield Input(REPORT, collection, f"report.{key}", RESULTS / f"{key}.json")
        yield Input(REPORT, self._arguments("benchmarks"), "report.results", RESULTS / "benchmarks.json")
        paper = self._arguments("paper")
        for name in ("cross_validation.json", "planning.json"):  # what is missing is said to be so
            yield Input(REPORT, paper, "report.results", RESULTS, name, may_do=True)

    def _of_trainings(self) -> Iterator[Input]:
        sweep, record = self._inputs / "sweep", self._inputs / "record"
        fold = sweep / "palm_points" / "unseen_fold0"
        learning = self._arguments("learning", runs=sweep)
        recorded = self._arguments("learning", runs="null")
        for file in ("metrics.json", "predictions.parquet", "curves.json"):
            unfinished = file == "metrics.json"  # and left out
            inner = f"palm_points/unseen_fold0/{file}"
            yield Input(REPORT, learning, "report.runs", sweep, inner, may_do=unfinished)
            yield Input(REPORT, recorded, "report.record", record, inner, may_do=unfinished)
        evaluation = self._inputs / "evaluation"
        curves = self._arguments("curves", run=fold, evaluation=evaluation)
        for file in ("metrics.json", "predictions.parquet", "curves.json"):
            yield Input(REPORT, curves, "report.run", fold, file)
        yield Input(REPORT, curves, "report.evaluation", evaluation, "evaluation.json")

    def _of_cornell(self) -> Iterator[Input]:
        images = self._inputs / "cornell"
        few = {"shown": 1, "compared": 1, "runs": "null"}
        nowhere = self._inputs / "no_results.json"
        cornell = self._arguments("cornell", **few, root=images)
        for file in CORNELL_FILES:
            yield Input(REPORT, (*cornell, f"report.results={nowhere}"), "report.root", images, file)
        yield Input(REPORT, cornell, "report.results", RESULTS / "cornell.json")
