"""Charts of the report: every series has its own mark and fill, so that none needs its colour."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

BLUE, VERMILION, GREEN, AMBER, PURPLE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7"
"""Okabe and Ito's colours."""
INK, QUIET, GRID = "#1d2227", "#5d6670", "#dedede"
PAPER = {"marker": "D", "color": VERMILION, "markerfacecolor": "white", "linestyle": "", "markersize": 5}
"""The paper's numbers, everywhere."""
SERIES = (
    {"marker": "o", "color": BLUE, "markersize": 5},
    {"marker": "s", "color": GREEN, "markerfacecolor": "white", "markersize": 4.5},
    {"marker": "^", "color": INK, "markerfacecolor": "white", "markersize": 5},
    {"marker": "v", "color": AMBER, "markersize": 5},
    {"marker": "x", "color": PURPLE, "markersize": 5},
)
LOOK = {
    "font.size": 8.5,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.7,
    "axes.titlesize": 9,
    "axes.labelsize": 8.5,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "pdf.fonttype": 42,
    "svg.hashsalt": "preshape",
}
WIDTH_IN = 7.0
"""Width of the text of a paper."""


@contextmanager
def look() -> Iterator[None]:
    """How all charts of the report look, while they are drawn and saved."""
    logging.getLogger("fontTools").setLevel(logging.WARNING)  # tells of every glyph that it embeds
    with matplotlib.rc_context(LOOK):
        yield


@dataclass(frozen=True)
class Rate:
    """A number with its interval; the bounds are None where there is none."""

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Series:
    """Rates by the names of rows, and how they are drawn.

    Args:
        label: stands in the legend.
        style: marks, as for Matplotlib.
        rates: what is known; rows that lack one stay empty.
    """

    label: str
    style: Mapping[str, Any]
    rates: Mapping[str, Rate]


@dataclass(frozen=True)
class Panel:
    """Rows of rates.

    Args:
        title: stands above.
        rows: names of the rows, from above.
        series: what is drawn; in each row the series that know it stand one below the other.
        span: ends of the axis.
    """

    title: str
    rows: Sequence[str]
    series: Sequence[Series]
    span: tuple[float, float] = (0.0, 1.0)


def rate_panels(panels: Sequence[Panel], xlabel: str) -> Figure:
    """Panels side by side; if all have the same rows, they are named once.

    Args:
        panels: what is drawn.
        xlabel: what all panels measure.
    """
    most = max(len(panel.series) for panel in panels)
    longest = max(len(panel.rows) for panel in panels)
    figure = Figure(figsize=(WIDTH_IN, (0.14 + 0.085 * most) * longest + 1.0), layout="constrained")
    same = all(panel.rows == panels[0].rows for panel in panels)
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        for y, name in enumerate(panel.rows):
            known = [series for series in panel.series if name in series.rates]
            for number, series in enumerate(known):
                shift = (number - (len(known) - 1) / 2) * 0.7 / max(1, most)
                _draw_rate(axes, series.rates[name], y + shift, series.style)
        axes.set_title(panel.title)
        _dress_rows(axes, panel, named=panel is panels[0] or not same)
    figure.supxlabel(xlabel, fontsize=8.5)
    named = {series.label: series.style for panel in panels for series in panel.series}
    handles = [Line2D([], [], label=label, **{**style, "linestyle": ""}) for label, style in named.items()]
    if len(handles) > 1:
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure


def _draw_rate(axes: Axes, rate: Rate, y: float, style: Mapping[str, Any]) -> None:
    if rate.low is not None and rate.high is not None:
        axes.plot((rate.low, rate.high), (y, y), color=style["color"], lw=1.1)
    axes.plot(rate.value, y, **{**style, "linestyle": ""})


def _dress_rows(axes: Axes, panel: Panel, *, named: bool) -> None:
    rows, (low, high) = panel.rows, panel.span
    axes.set_yticks(range(len(rows)), rows if named else [""] * len(rows))
    axes.tick_params(axis="y", length=0)
    margin = 0.03 * (high - low)
    axes.set(xlim=(low - margin, high + margin), ylim=(len(rows) - 0.5, -0.5))
    step = 0.25 if high - low == 1.0 else 0.1
    ticks = np.arange(low, high + step / 2, step).round(3)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.grid(axis="x", color=GRID, linewidth=0.6)
    axes.spines[["top", "right", "left"]].set_visible(False)
    for y in range(1, len(rows)):
        axes.axhline(y - 0.5, color=GRID, linewidth=0.5)


def reliability_panels(panels: Mapping[str, Mapping[str, Any]]) -> Figure:
    """Predicted probability against what lifted, a panel for each; marks grow with the number of grasps.

    Args:
        panels: `reliability` of a result file by the titles of the panels.
    """
    figure = Figure(figsize=(WIDTH_IN, WIDTH_IN / len(panels) + 0.75), layout="constrained")
    all_axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    for axes, (title, said) in zip(all_axes, panels.items(), strict=True):
        diagram = said["diagram"]
        filled = np.array(diagram["count"]) > 0
        count, predicted, observed, low, high = (
            np.array(diagram[name], dtype=float)[filled]
            for name in ("count", "predicted", "observed", "low", "high")
        )
        axes.plot((0, 1), (0, 1), color=QUIET, linestyle=":", linewidth=1)
        axes.vlines(predicted, low, high, color=BLUE, linewidth=1)
        axes.scatter(
            predicted, observed, 14 + 90 * count / count.sum(), color=BLUE, edgecolor="white", zorder=3
        )
        axes.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), aspect="equal", xlabel="predicted")
        axes.set_title(f"{title}\ncalibration error {said['predicted_as_planned']['ece']:.2f}")
        axes.grid(color=GRID, linewidth=0.6)
    all_axes[0].set_ylabel("lifted of executed")
    return figure


def lines_with_intervals(
    panels: Mapping[str, Mapping[str, Mapping[float, Rate]]], xlabel: str, ylabel: str, *, log: bool = False
) -> Figure:
    """Lines over numbers, with intervals, in panels side by side.

    Args:
        panels: titles of panels -> labels of lines -> numbers -> rates.
        xlabel, ylabel: names of the axes.
        log: whether the numbers are powers of two.
    """
    figure = Figure(figsize=(WIDTH_IN, 3.0), layout="constrained")
    all_axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    dashes = ("-", "--", "-.", ":")
    for axes, (title, lines) in zip(all_axes, panels.items(), strict=True):
        for number, (label, points) in enumerate(lines.items()):
            x = np.array(list(points), dtype=float) * (1 + 0.012 * number if log else 1)
            y, low, high = (
                np.array([getattr(rate, part) for rate in points.values()], dtype=float)
                for part in ("value", "low", "high")
            )
            style = {**SERIES[number % len(SERIES)], "linestyle": dashes[number % len(dashes)]}
            axes.errorbar(x, y, (y - low, high - y), label=label, elinewidth=0.8, capsize=2, lw=1.2, **style)
        if log:
            axes.set_xscale("log", base=2)
        ticks = sorted({value for points in lines.values() for value in points})
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        axes.set(title=title, xlabel=xlabel, ylim=(0, 1.03))
        axes.grid(color=GRID, linewidth=0.6)
    all_axes[0].set_ylabel(ylabel)
    all_axes[0].legend(loc="lower right")
    return figure
