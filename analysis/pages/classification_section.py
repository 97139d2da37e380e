"""The report's section about learning grasp success, beside the paper's cross validation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import t as student_t

from analysis.learning.roc_curves import read_curve
from analysis.learning.tables import METRICS, PAPER_AUC, PAPER_DECISIONS, PAPER_RANDOM, SPLITS
from analysis.pages.report_blocks import Block, Cell, Chart, Missing, Row, Section, Table
from analysis.pages.report_charts import PAPER, SERIES, Panel, Rate, Series, rate_panels
from analysis.result_files import ResultFiles
from preshape.evaluation.average_roc import average_roc_figure

FOLDS = 5
SOURCE = ["cross_validation"]
AREAS = (0.5, 1.0)
"""Ends of the axis: chance and perfection."""
REFRESH = "python analysis/report.py report=learning"
NO_CURVES = Missing(
    "Average ROC curves",
    ["python src/train.py --multirun split=seen,unseen fold=0,1,2,3,4", REFRESH],
    "A picture of two curves with areas of 0.83 and 0.82 (figure 4).",
    "Result files hold no points of curves yet; the areas are below.",
)


@dataclass(frozen=True)
class Network:
    """A network that should be cross validated.

    Args:
        label: what is written beside it.
        group: its group in the result file.
        command: what measures it.
        predicts: `success`, or `grasps` for regression.
        paper: what the paper says of it, if it gives no figures; shown while it is not measured.
    """

    label: str
    group: str
    command: str
    predicts: str = "success"
    paper: str = ""


Runs = Mapping[tuple[str, str], Mapping[str, Any]]


def classification_section(results: ResultFiles, networks: Sequence[Network]) -> Section:
    """ROC curves, areas, decisions and regression; what was not run is named with its command."""
    content = results.find("cross_validation") or {"runs": ()}
    runs = {(run["group"], run["split"]): run for run in content["runs"]}
    predicting = [network for network in networks if network.predicts == "success"]
    blocks: list[Block] = [*_roc(runs, predicting)]
    if any((network.group, split) in runs for network in predicting for split in SPLITS):
        blocks += [_areas(runs, predicting), _decisions(runs, predicting), _calibration(runs, predicting)]
    regression = [network for network in networks if network.predicts == "grasps"]
    blocks += [_grasp_errors(runs, network) for network in regression if _folds(runs, network)]
    blocks += [_missing(runs, network) for network in networks if not _complete(runs, network)]
    lead = [
        "Networks are cross validated in five folds: on seen objects, with trials held out at random, and on "
        "unseen ones, with whole objects held out. “Default” is another network than the paper's: five "
        "networks that see the object's points in the palm's frame.",
        "Intervals are 95 % Student intervals of the mean over the folds. Folds share most of their training "
        "trials, so that they are approximate. The paper prints means and standard deviations.",
    ]
    return Section("classification", "Predicting success", lead, blocks, "Section 4.2")


def _folds(runs: Runs, network: Network) -> dict[str, int]:
    found = {split: runs.get((network.group, split)) for split in SPLITS}
    return {split: len(run["folds"]) for split, run in found.items() if run is not None}


def _complete(runs: Runs, network: Network) -> bool:
    known = _folds(runs, network)
    return all(known.get(split, 0) >= FOLDS for split in SPLITS)


def _missing(runs: Runs, network: Network) -> Missing:
    known = _folds(runs, network)
    done = ", ".join(f"{split}: {count} of {FOLDS} folds" for split, count in known.items())
    paper = network.paper or "; ".join(f"AUC {split}: {_paper_area(split)}" for split in SPLITS) + "."
    return Missing(
        network.label, [network.command, REFRESH], paper, f"Measured so far: {done}." if done else ""
    )


def _roc(runs: Runs, networks: Sequence[Network]) -> list[Block]:
    """A figure of each network with several folds."""
    blocks: list[Block] = []
    for network in networks:
        known = {split: run for split in SPLITS if (run := runs.get((network.group, split))) is not None}
        curves = {split: read_curve(run["roc"]) for split, run in known.items() if run.get("roc")}
        if curves and any(len(run["folds"]) > 1 for run in known.values()):
            references = {split: PAPER_AUC[split] for split in curves}
            figure = average_roc_figure(curves, network.label, references)
            figure.set_size_inches(4.6, 4.6)
            areas = ", ".join(f"{split} {curve.auc_mean:.3f}" for split, curve in curves.items())
            blocks.append(
                Chart(
                    f"roc_{network.group.replace(',', '_').replace('=', '_')}",
                    f"Average ROC curves: {network.label}",
                    figure,
                    f"ROC curves of {network.label}; areas: {areas}",
                    SOURCE,
                    "Fig. 4",
                    "Vertical averages over the folds; bands are one standard deviation. "
                    "The paper prints areas and a picture, no points of its curves.",
                )
            )
    return blocks or [NO_CURVES]


def _areas(runs: Runs, networks: Sequence[Network]) -> Chart:
    panels = []
    labels = ["paper, config-CNN", *(network.label for network in networks)]
    for split in SPLITS:
        mean, std = (float(part) for part in _paper_area(split).split(" ± "))
        known = {n.label: runs[n.group, split]["auc"]["folds"] for n in networks if (n.group, split) in runs}
        series = [
            Series("paper, ± 1 standard deviation", PAPER, {labels[0]: Rate(mean, mean - std, mean + std)}),
            Series(
                "ours, mean of the folds, 95 % interval",
                SERIES[0],
                {label: mean_of_folds(folds) for label, folds in known.items()},
            ),
        ]
        panels.append(Panel(f"{split} objects", labels, series, span=AREAS))
    figure = rate_panels(panels, "area under the ROC curve (chance: 0.5)")
    words = "AUC of each network on seen and on unseen objects; rows without a mark are not measured yet"
    note = "A row without a mark has not been measured; a mark of ours without an interval is a single fold."
    return Chart("auc", "Area under the ROC curve", figure, words, SOURCE, "Fig. 4, caption", note)


def _paper_area(split: str) -> str:
    return PAPER_AUC[split].removeprefix("paper ")


def mean_of_folds(values: Sequence[float], largest: float = 1.0) -> Rate:
    """Mean over folds with its 95 % Student interval, cut off at 0 and `largest`; none of one fold."""
    mean = float(np.mean(values))
    if len(values) < 2:
        return Rate(mean)
    half = float(student_t.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / np.sqrt(len(values)))
    return Rate(mean, max(0.0, mean - half), min(largest, mean + half))


def _decisions(runs: Runs, networks: Sequence[Network]) -> Table:
    """The paper's only table."""
    rows: list[Row] = []
    for split in SPLITS:
        accuracy, f1 = PAPER_DECISIONS[split]
        counts = ("1,507", "159", "5")
        rows.append([Cell(text, "paper") for text in ("paper, config-CNN", split, *counts, accuracy, f1)])
        rows += [_decision_row(network, split, runs.get((network.group, split))) for network in networks]
    random = next((run["baselines"]["random"] for run in runs.values() if "random" in run["baselines"]), None)
    if random is not None and "accuracy" in random:
        rows.append(["random", "", "", "", "", *(_spread(random[name]) for name in ("accuracy", "f1"))])
    rows.append([Cell(text, "paper") for text in ("paper, random", "", "", "", "", *PAPER_RANDOM)])
    return Table(
        "decisions",
        "Accuracy and F1 at a probability of 0.4",
        ("network", "objects", "n", "lifted", "folds", "accuracy", "F1"),
        rows,
        SOURCE,
        "Table 1",
        "Mean and standard deviation over the folds, then the interval of the mean. The paper's data hold "
        "10.6 % lifted grasps, ours four times as many: F1 and accuracy depend on that share, the "
        "AUC does not.",
    )


def _decision_row(network: Network, split: str, run: Mapping[str, Any] | None) -> Row:
    if run is None:
        return [network.label, split, Cell("not measured yet", "missing"), "", "", "", ""]
    counts = (f"{run['n']:,}", f"{run['positives']:,}", str(len(run["folds"])))
    return [network.label, split, *counts, *(_spread(run[name]) for name in ("accuracy", "f1"))]


def _calibration(runs: Runs, networks: Sequence[Network]) -> Table:
    names = ("auc", "ap", "brier", "ece")
    rows = [
        [network.label, split, *(_interval(run[name]) if name in run else "–" for name in names)]
        for network in networks
        for split in SPLITS
        if (run := runs.get((network.group, split))) is not None
    ]
    return Table(
        "metrics",
        "More of the same trials",
        ("network", "objects", *(METRICS.get(name, name) for name in names)),
        rows,
        SOURCE,
        note="AP: average precision. Brier and ECE, the expected calibration error, are after temperature "
        "scaling on validation trials.",
    )


def _grasp_errors(runs: Runs, network: Network) -> Table:
    names = ("palm_m", "palm_smallest_m", "orientation_rad", "joints_rad")
    rows: list[Row] = [[Cell(text, "paper") for text in ("paper", "", "", "> 0.4", "> 0.2", "far", "far")]]
    for split in SPLITS:
        run = runs.get((network.group, split))
        if run is not None:
            about = (split, f"{run['n']:,}", *(_spread(run[name], np.inf) for name in names))
            rows.append([network.label, *about])
    header = ("network", "objects", "n", "palm (m)", "palm, best (m)", "orientation (rad)", "joints (rad)")
    note = "Errors at held-out grasps that lifted."
    return Table("regression", "Regression of grasps", header, rows, SOURCE, "Section 4.2, text", note)


def _interval(values: Mapping[str, Any]) -> str:
    """Mean over the folds and its interval."""
    rate = mean_of_folds(values["folds"])
    bounds = "" if rate.low is None else f" [{rate.low:.3f}, {rate.high:.3f}]"
    return f"{rate.value:.3f}{bounds}"


def _spread(values: Mapping[str, Any], largest: float = 1.0) -> str:
    """Mean, standard deviation over the folds, and the interval of the mean."""
    rate = mean_of_folds(values["folds"], largest)
    if rate.low is None or rate.high is None:
        return f"{rate.value:.3f}"
    return f"{rate.value:.3f} ({values['std']:.3f}) [{rate.low:.3f}, {rate.high:.3f}]"
