"""The report's sections about the paper's real robots, beside what stands for them in simulation."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from analysis.pages.report_blocks import Block, Cell, Chart, Missing, Picture, Row, Section, Table
from analysis.pages.report_charts import SERIES, Panel, Rate, Series, lines_with_intervals, rate_panels
from analysis.paper_figures import paper_number, paper_objects
from analysis.planning.tables import number, points, probability, share
from analysis.result_files import ResultFiles
from analysis.wording import plain_name, planner_name

Run = Mapping[str, Any]
HAND = {"heuristic": SERIES[1], "max_eval": SERIES[2], "inference": SERIES[0]}
GRIPPER = {"heuristic": SERIES[1], "inference": SERIES[0]}
REAL_ROBOT = Missing(
    "Grasps by a real Allegro hand",
    [],
    "5 YCB objects in 5 poses each: heuristic 37 %, max-eval 56 %, inference 88 % (figure 7).",
    "No robot was used here. The simulated grasps of scanned YCB objects below are another experiment.",
)
NO_GRIPPER = Missing(
    "Two-finger grasps, executed",
    [
        "python src/train.py experiment=two_finger_unseen",
        "python sim/evaluate.py experiment=two_finger",
        "python analysis/report.py report=gripper robot=baxter",
    ],
    "10 objects in 3 poses each on a real Baxter: initial rectangles 40 %, inference 84 %; "
    "predicted 0.29 and "
    "0.98 (figure 9).",
)
NO_CORNELL = Missing(
    "Rectangles of the Cornell data",
    [
        "python src/train.py --multirun model=patches_cnn dataset=cornell dataset.root=DIR "
        "split=scenes,unseen "
        "fold=0,1,2,3,4",
        "python src/detect.py dataset.root=DIR",
    ],
    "“Similar classification performance” as Lenz et al., without a number (section 4.5).",
)


def hand_section(results: ResultFiles, pictures: Path) -> Section:
    """The paper's real Allegro hand, beside scanned objects in simulation."""
    blocks: list[Block] = [REAL_ROBOT]
    runs = [
        run for run in _runs(results, "planning") if run["condition"] == "scans" and run["planner"] in HAND
    ]
    if runs:
        blocks += _scans(runs)
    blocks.append(
        Picture(
            "examples",
            "A grasp of a scanned power drill that lifted it",
            pictures / "scanned_objects_lifted.png",
            "Four moments of a trial: before the approach, in the grasp, during the lift, after it",
            "python sim/replay.py objects=mesh_folder objects.root=DIR table=outputs/collect/ycb trials=[13]",
            "Fig. 8",
            "From the collection of trials. The paper shows grasps by its inference.",
        )
    )
    lead = ["The paper's networks, trained in simulation, planned for a real Allegro hand on an LBR4 arm."]
    return Section("real-robot", "Multi-fingered grasps on a real robot", lead, blocks, "Section 4.4")


def _scans(runs: Sequence[Run]) -> list[Block]:
    chart = Chart(
        "scans",
        "Scanned YCB objects in simulation (right), and the paper's robot (left)",
        _beside("real_robot", runs, HAND, "rate"),
        "Success rates per object: the paper's five objects on a robot, ours in simulation",
        ["planning"],
        "Fig. 7",
        "Other objects, another world: the panels share their axis, nothing else. Intervals are 95 % Wilson.",
    )
    rows: list[Row] = [
        [planner_name(run["planner"]), f"{run['lifted']} of {run['executed']}", share(run), _paper_rate(run)]
        for run in runs
    ]
    header = ("planner", "lifted", "rate, simulated scans", "paper, real robot")
    table = Table("scans_table", "All objects together", header, rows, ["planning"], "Fig. 7, “All”")
    return [chart, table]


def gripper_section(results: ResultFiles) -> Section:
    """The paper's two-finger experiment, beside the simulated gripper and the Cornell data."""
    blocks: list[Block] = []
    content = results.find("two_finger")
    if content is None:
        blocks.append(NO_GRIPPER)
    else:
        blocks += _executed_rectangles(content)
    cornell = results.find("cornell")
    blocks += [NO_CORNELL] if cornell is None else _cornell(cornell["runs"])
    lead = [
        "The paper learned patches-CNN from the Cornell grasp data and executed its rectangles "
        "with a real Baxter; "
        "here a simulated parallel gripper executes them."
    ]
    return Section("two-finger", "Two-finger grasps", lead, blocks, "Section 4.5")


def _runs(results: ResultFiles, name: str) -> Sequence[Run]:
    content = results.find(name)
    return () if content is None else content["runs"]


def _paper_rate(run: Run, condition: str = "real_robot") -> Cell:
    rate = paper_number(condition, run["planner"], "all").rate
    return Cell("–" if rate is None else f"{100 * rate:.0f} %", "paper")


def _beside(
    condition: str, runs: Sequence[Run], styles: Mapping[str, Mapping[str, Any]], shown: str
) -> Figure:
    """The paper's objects beside ours, which are not the same."""
    printed, measured = [], []
    theirs = [*paper_objects(condition)]
    for planner, style in styles.items():
        found = {name: getattr(paper_number(condition, planner, name), shown) for name in theirs}
        known = {plain_name(name): Rate(value) for name, value in found.items() if value is not None}
        printed.append(Series(planner_name(planner), style, known))
        own = next((run for run in runs if run["planner"] == planner), None)
        if own is not None:
            entries = {**own["objects"], "all": own}
            rates = {plain_name(n): _rate(one, shown) for n, one in entries.items() if one["executed"]}
            measured.append(Series(planner_name(planner), style, rates))
    ours = [*sorted({name for run in runs for name in run["objects"]}), "all"]
    panels = [
        Panel("paper, real robot", [plain_name(name) for name in theirs], printed),
        Panel("ours, simulated", [plain_name(name) for name in ours], measured),
    ]
    words = "share of executed grasps that lifted" if shown == "rate" else "mean predicted probability"
    return rate_panels(panels, words)


def _rate(entry: Mapping[str, Any], shown: str) -> Rate:
    return Rate(entry["rate"], entry["low"], entry["high"]) if shown == "rate" else Rate(entry["predicted"])


def _executed_rectangles(content: Mapping[str, Any]) -> list[Block]:
    blocks: list[Block] = []
    for condition in dict.fromkeys(run["condition"] for run in content["runs"]):
        runs = [run for run in content["runs"] if run["condition"] == condition]
        for shown, title in (("rate", "Success"), ("predicted", "Predicted probability")):
            blocks.append(
                Chart(
                    f"gripper_{condition}_{shown}",
                    f"{title} of two-finger grasps: {plain_name(condition)}",
                    _beside("two_finger", runs, GRIPPER, shown),
                    f"{title} per object of initial rectangles and of inference, the paper's beside ours",
                    ["two_finger"],
                    "Fig. 9",
                    "The paper's Baxter was real, ours is simulated, and the objects are others.",
                )
            )
    rows: list[Row] = []
    for run in content["runs"]:
        of_paper = paper_number("two_finger", run["planner"], "all").predicted
        cells = (f"{run['lifted']} of {run['executed']}", share(run) if run["executed"] else "–")
        predicted = (number(run["predicted"]), Cell(number(of_paper), "paper"))
        about = (planner_name(run["planner"]), plain_name(run["condition"]), *cells)
        rows.append([*about, _paper_rate(run, "two_finger"), *predicted])
    header = ("planner", "learned from", "lifted", "rate", "paper", "predicted", "paper")
    note = "; ".join(
        f"inference − {planner_name(test['against']).lower()}, {plain_name(test['condition'])}: "
        f"{points(test['difference'])} points on {test['n']} scenes, p {probability(test['p'])} (McNemar)"
        for test in content["tests"]
    )
    title = "All objects together"
    blocks.append(Table("gripper_all", title, header, rows, ["two_finger"], "Fig. 9, “All”", note))
    return blocks


def _cornell(runs: Sequence[Run]) -> list[Block]:
    blocks: list[Block] = []
    for data in dict.fromkeys(run["data"] for run in runs):
        own = {(run["folds"], run["metric"]): run for run in runs if run["data"] == data}
        folds = sorted({folds for folds, _ in own})
        images = max(
            (run["n"] for (_, metric), run in own.items() if metric.startswith("detection")), default=0
        )
        named = f"{plain_name(data).capitalize()} data, {images} images"
        panels = {plain_name(fold): _detection_lines(own, fold) for fold in folds}
        if any(panels.values()):
            figure = lines_with_intervals(
                panels, "initial rectangles", "correct (rectangle metric)", log=True
            )
            blocks.append(
                Chart(
                    f"detection_{data}",
                    f"Detection against the number of initial rectangles: {named}",
                    figure,
                    "Share of images whose proposed rectangle is correct, for 1 to 64 initial rectangles",
                    ["cornell"],
                    note="Intervals are 95 % Wilson over the images. The paper plans from 4.",
                )
            )
        metrics = list(dict.fromkeys(metric for _, metric in own))
        rows: list[Row] = [
            [metric.replace("_", " "), *(_cornell_cell(own.get((fold, metric))) for fold in folds)]
            for metric in metrics
        ]
        title = f"Rectangles: {named}"
        header = ("figure", *(plain_name(fold) for fold in folds))
        blocks.append(Table(f"rectangles_{data}", title, header, rows, ["cornell"], note=NOTE_ON_CORNELL))
    return blocks


NOTE_ON_CORNELL = (
    "Recognition: of labelled rectangles. Detection: of one rectangle per image; the number behind "
    "a method is "
    "how many initial rectangles it had. The paper gives no such figures for the Cornell data. The number "
    "of images says how many were at hand; the whole Cornell data set has 885."
)


def _detection_lines(own: Mapping[tuple[str, str], Run], fold: str) -> dict[str, dict[float, Rate]]:
    lines: dict[str, dict[float, Rate]] = {}
    for method in ("inference", "max_eval"):
        prefix = f"detection_{method}_"
        found = {
            float(metric.removeprefix(prefix)): Rate(run["value"], run["low"], run["high"])
            for (own_fold, metric), run in own.items()
            if own_fold == fold and metric.startswith(prefix)
        }
        if found:
            lines[planner_name(method)] = dict(sorted(found.items()))
    return lines


def _cornell_cell(run: Run | None) -> str | Cell:
    if run is None:
        return Cell("not measured yet", "missing")
    if run["low"] is None:
        return f"{run['value']:.3f} (n = {run['n']})"
    return f"{run['value']:.3f} [{run['low']:.3f}, {run['high']:.3f}] (n = {run['n']})"
