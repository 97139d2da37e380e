"""The report's section about planning in simulation, beside the paper's two figures."""

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.pages.report_blocks import Block, Cell, Chart, Missing, Row, Section, Table
from analysis.pages.report_charts import PAPER, SERIES, Panel, Rate, Series, rate_panels
from analysis.paper_figures import ALL, paper_number
from analysis.planning.charts import object_figure
from analysis.planning.tables import number, points, probability, share
from analysis.result_files import ResultFiles
from analysis.wording import planner_name

Run = Mapping[str, Any]
SPLITS = ("seen", "unseen")
SOURCE = ["planning"]
METHODS = ("heuristic", "max_eval", "sampling", "inference")
"""The paper's."""
OF_PAPER_NETWORK = (*METHODS, "paper_constrained")
OTHERS = ("cem", "random_search", "map_mixture", "map_network")
"""What the paper does not compare with."""
PAPER_SECONDS = {
    "heuristic": "–",
    "max_eval": "0.1 to 0.2, for 3 initial grasps",
    "sampling": "about 6, for 150 samples",
    "inference": "2 to 3 for each initial grasp",
}
NOT_PLANNED = Missing(
    "Success rates and predicted probabilities per object",
    [
        "python sim/evaluate.py experiment=planning",
        "python sim/evaluate.py experiment=planning_paper",
        "python analysis/report.py report=planning",
    ],
    "Seen objects: inference 62 %, sampling 28 %, max-eval 48 %, heuristic 31 %; unseen: 52, 18, 42, 34 % "
    "(figures 5 and 6).",
)


def simulation_section(results: ResultFiles) -> Section:
    """The paper's figures of its ten objects, with its own network and with ours."""
    lead = [
        "Every planner has the same scenes and initial grasps of the paper's ten test objects. Of the "
        "heuristic every initial grasp is executed, of the others the best that the arm can reach. The paper "
        "has five poses of each object, for every planner others.",
        "“The paper's steps, kept off table and object” is the paper's gradient ascent in "
        "config-CNN, with our "
        "constraint. Without it, as “inference with the paper's steps”, most of its grasps would "
        "touch the table "
        "or the object on their way and are not executed here. “Inference” is ours, in either network.",
    ]
    content = results.find("planning")
    if content is None:
        return Section("simulation", "Planning in simulation", lead, [NOT_PLANNED], "Section 4.3")
    blocks: list[Block] = [_overview(content), _counts(content)]
    default, paper = content["runs"], content["paper_network"]["runs"]
    blocks += _per_object(_chosen(default, METHODS), "default network", "default")
    if paper:
        blocks += _per_object(
            _chosen(paper, OF_PAPER_NETWORK), "config-CNN, the paper's network", "config_cnn"
        )
    blocks += [_seconds(content), _tests(content)]
    return Section("simulation", "Planning in simulation", lead, blocks, "Section 4.3")


def _chosen(runs: Sequence[Run], planners: Sequence[str]) -> list[Run]:
    """The runs of some planners on the paper's objects, in the order of the planners."""
    known = {(run["condition"], run["planner"]): run for run in runs}
    return [known[split, name] for split in SPLITS for name in planners if (split, name) in known]


def _rate(run: Run) -> Rate:
    return Rate(run["rate"], run["low"], run["high"])


def _overview(content: Mapping[str, Any]) -> Chart:
    rows = [planner_name(name) for name in (*METHODS, "paper_constrained", *OTHERS)]
    panels = []
    for split in SPLITS:
        sources = (
            ("paper", PAPER, None, ()),
            ("config-CNN here", SERIES[1], content["paper_network"]["runs"], OF_PAPER_NETWORK),
            ("default network", SERIES[0], content["runs"], (*METHODS, *OTHERS)),
        )
        series = [
            Series(label, style, _paper_rates(split) if runs is None else _rates(runs, split, planners))
            for label, style, runs, planners in sources
        ]
        panels.append(Panel(f"{split} objects", rows, series))
    figure = rate_panels(panels, "share of executed grasps that lifted, 95 % Wilson intervals")
    words = (
        "Share of executed grasps that lifted, by planner, network and split; the table below has the numbers"
    )
    note = (
        "The paper's 62 % and 52 % of inference stand in both rows of it: with our rules around it, and with "
        "its own steps kept off table and object."
    )
    return Chart("overview", "Ten objects together", figure, words, SOURCE, "Fig. 5, “All”", note)


def _paper_rates(split: str) -> dict[str, Rate]:
    found = {name: paper_number(split, name, ALL).rate for name in OF_PAPER_NETWORK}
    return {planner_name(name): Rate(value) for name, value in found.items() if value is not None}


def _rates(runs: Sequence[Run], split: str, planners: Sequence[str]) -> dict[str, Rate]:
    return {
        planner_name(run["planner"]): _rate(run)
        for run in runs
        if run["condition"] == split and run["planner"] in planners and run["executed"]
    }


def _counts(content: Mapping[str, Any]) -> Table:
    rows: list[Row] = []
    for network, runs, planners in (
        ("default", content["runs"], (*METHODS, *OTHERS)),
        ("config-CNN", content["paper_network"]["runs"], (*OF_PAPER_NETWORK, "paper", "regression")),
    ):
        for run in _chosen(runs, planners):
            printed = paper_number(run["condition"], run["planner"], ALL)
            rows.append(
                [
                    planner_name(run["planner"]),
                    network,
                    run["condition"],
                    f"{run['lifted']} of {run['executed']}",
                    share(run),
                    _paper_cell(printed.rate),
                    f"{share(run['scenes'])} of {run['n']}",
                    number(run["predicted"]),
                    Cell("–" if printed.predicted is None else number(printed.predicted), "paper"),
                ]
            )
    header = (
        "planner",
        "network",
        "objects",
        "lifted",
        "rate",
        "paper",
        "of all scenes",
        "predicted",
        "paper",
    )
    note = (
        "Rate: of executed grasps, as in the paper. “Of all scenes” counts a scene without a grasp "
        "within reach "
        "as a failure; of the heuristic one grasp a scene counts, drawn by lot. Predicted: mean probability "
        "that the network gave to the executed grasps."
    )
    return Table("planners", "All planners", header, rows, SOURCE, "Figs. 5 and 6, “All”", note)


def _paper_cell(rate: float | None) -> Cell:
    return Cell("–" if rate is None else f"{100 * rate:.0f} %", "paper")


def _per_object(runs: Sequence[Run], network: str, name: str) -> list[Block]:
    return [
        Chart(
            f"rate_{name}",
            f"Success per object: {network}",
            object_figure(runs, "rate"),
            f"Share of executed grasps that lifted for each of ten objects and each planner, with {network}",
            SOURCE,
            "Fig. 5",
        ),
        Chart(
            f"predicted_{name}",
            f"Predicted probability per object: {network}",
            object_figure([run for run in runs if run["planner"] in ("heuristic", "inference")], "predicted"),
            f"Mean predicted probability for each of ten objects before and after inference, with {network}",
            SOURCE,
            "Fig. 6",
            "The ticks say what share of the same grasps lifted: a network that knows its limits "
            "has its dots there.",
        ),
    ]


def _seconds(content: Mapping[str, Any]) -> Table:
    both = {"default": content["runs"], "config-CNN": content["paper_network"]["runs"]}
    rows: list[Row] = []
    for planner in METHODS:
        found = {
            network: next((run for run in _chosen(runs, [planner]) if run["condition"] == "seen"), None)
            for network, runs in both.items()
        }
        cells = [
            "–" if run is None else f"{run['seconds']:.3f} ({run['evaluations']:.0f})"
            for run in found.values()
        ]
        rows.append([planner_name(planner), *cells, Cell(PAPER_SECONDS[planner], "paper")])
    header = ("planner", "default: s (evaluations)", "config-CNN: s (evaluations)", "paper: s")
    note = (
        "Means over 200 scenes with seen objects: seconds for all initial grasps of a scene "
        "together, beside other "
        "work and without image features, and evaluations of the network. The paper's are from a GTX 970."
    )
    return Table("seconds", "Time to plan", header, rows, SOURCE, "Section 4.3, text", note)


def _tests(content: Mapping[str, Any]) -> Table:
    rows: list[Row] = [
        [
            f"{planner_name(test['planner'])} − {planner_name(test['against'])}",
            network,
            test["condition"],
            str(test["n"]),
            points(test["difference"]),
            f"{test['first_only']} / {test['second_only']}",
            probability(test["p"]),
            f"{points(whole['difference'])}, p {probability(whole['p'])}",
        ]
        for network, part in (("default", content), ("config-CNN", content["paper_network"]))
        for test, whole in zip(part["tests"], part["tests_of_all_scenes"], strict=True)
        if test["condition"] in SPLITS and test["against"] in (*METHODS, *OTHERS)
    ]
    header = (
        *("difference", "network", "objects", "scenes", "points"),
        *("only first / only second lifted", "p", "all scenes"),
    )
    note = (
        "Exact McNemar tests on the scenes on which both executed a grasp, then on all scenes; "
        "percentage points. "
        "The paper tests nothing. P-values are not corrected for their number."
    )
    return Table("tests", "Paired tests", header, rows, SOURCE, note=note)
