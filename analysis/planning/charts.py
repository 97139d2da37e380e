"""The paper's two figures of its simulation experiment, ours and the paper's numbers in each panel."""

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.dataset.charts import BLUE, ORANGE
from analysis.paper_figures import ALL, paper_number
from analysis.wording import plain_name, planner_name

Shown = Literal["rate", "predicted"]
Run = Mapping[str, Any]
TITLE_WIDTH = 18
"""Letters in a line of a panel's title."""
OURS = {"color": BLUE, "marker": "o", "linestyle": "", "markersize": 4}
EXECUTED = {"color": "#767676", "marker": "|", "linestyle": "", "markersize": 7}
PAPER = {"color": ORANGE, "marker": "D", "markerfacecolor": "white", "linestyle": "", "markersize": 4}


def object_figure(runs: Sequence[Run], shown: Shown) -> Figure:
    """A row of panels for each condition, a panel for each planner, a line for each object.

    Args:
        runs: rows of the result file.
        shown: `rate`, with its interval; or `predicted`, with the rate as a tick.
    """
    conditions = list(dict.fromkeys(run["condition"] for run in runs))
    planners = list(dict.fromkeys(run["planner"] for run in runs))
    names = {c: _names([run for run in runs if run["condition"] == c]) for c in conditions}
    heights = [len(names[condition]) for condition in conditions]
    figure = Figure(
        figsize=(2.4 + 1.25 * len(planners), 0.16 * sum(heights) + 0.55 * len(conditions) + 0.5),
        layout="constrained",
    )
    grid = figure.subplots(len(conditions), len(planners), squeeze=False, height_ratios=heights)
    for axes, planner in zip(grid[0], planners, strict=True):
        axes.set_title(fill(planner_name(planner), TITLE_WIDTH), fontsize=8)
    for row, condition in zip(grid, conditions, strict=True):
        own = {run["planner"]: run for run in runs if run["condition"] == condition}
        for axes, planner in zip(row, planners, strict=True):
            if planner in own:
                _draw(axes, own[planner], names[condition], shown)
            _dress(axes, names[condition], named=axes is row[0])
        row[0].set_ylabel(condition, fontsize=9)
    text = (
        "share of executed grasps that lifted" if shown == "rate" else "mean predicted probability of success"
    )
    figure.supxlabel(text, fontsize=9)
    _add_legend(figure, shown)
    return figure


def _names(runs: Sequence[Run]) -> list[str]:
    return [*sorted({name for run in runs for name in run["objects"]}), ALL]


def _draw(axes: Axes, run: Run, names: Sequence[str], shown: Shown) -> None:
    of_rows = [run if name == ALL else run["objects"].get(name) for name in names]
    known = [(y, rate) for y, rate in enumerate(of_rows) if rate is not None and rate["executed"]]
    rows = [y for y, _ in known]
    if shown == "rate":
        axes.hlines(rows, *([rate[end] for _, rate in known] for end in ("low", "high")), BLUE, linewidth=1.2)
    else:
        axes.plot([rate["rate"] for _, rate in known], rows, **EXECUTED)
    axes.plot([rate[shown] for _, rate in known], rows, **OURS)
    paper = [getattr(paper_number(run["condition"], run["planner"], name), shown) for name in names]
    printed = [(value, y) for y, value in enumerate(paper) if value is not None]
    axes.plot([value for value, _ in printed], [y for _, y in printed], **PAPER)


def _dress(axes: Axes, names: Sequence[str], *, named: bool) -> None:
    labels = [plain_name(name) for name in names] if named else [""] * len(names)
    axes.set_yticks(range(len(names)), labels, fontsize=6.5)
    axes.tick_params(axis="y", length=0)
    axes.set(xlim=(-0.05, 1.05), ylim=(len(names) - 0.5, -0.5))
    axes.set_xticks((0, 0.5, 1), ("0", "0.5", "1"), fontsize=7)
    axes.axhline(len(names) - 1.5, color="#aaaaaa", linewidth=0.6)
    axes.grid(axis="x", color="#e3e3e3", linewidth=0.6)


def _add_legend(figure: Figure, shown: Shown) -> None:
    entries = [("ours, 95 % interval" if shown == "rate" else "ours, predicted", OURS)]
    if shown == "predicted":
        entries.append(("ours, lifted of executed", EXECUTED))
    entries.append(("paper", PAPER))
    handles = [Line2D([], [], label=label, **style) for label, style in entries]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False, fontsize=8)
