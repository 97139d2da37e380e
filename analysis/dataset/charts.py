"""Charts of a data set, readable without colour: every series has its own mark, line or hatch as well."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from analysis.dataset.grasps import GRASP_TYPES
from analysis.dataset.rates import RateBin, binned_rates, gridded_counts
from analysis.lift_rates import LiftRate
from analysis.wording import plain_name

BLUE, ORANGE, GREY = "#0072b2", "#b24a00", "#767676"
STYLES = {
    "side": {"color": BLUE, "marker": "o", "linestyle": "-"},
    "overhead": {"color": ORANGE, "marker": "s", "linestyle": "--", "markerfacecolor": "white"},
}
OUTCOME_FILLS = {
    "lifted": {"color": BLUE, "hatch": ""},
    "dropped": {"color": "#e69f00", "hatch": "////"},
    "missed": {"color": "#f3d9a4", "hatch": ""},
    "blocked": {"color": "#9a9a9a", "hatch": "...."},
    "unreachable": {"color": "#d9d9d9", "hatch": ""},
    "unstable": {"color": "#ffffff", "hatch": "xxxx"},
}
"""Executed outcomes come first."""
Groups = Sequence[tuple[str, Mapping[str, LiftRate]]]
"""Headings, each with the rates that stand under it."""
BINS = 8
GRID_M = np.linspace(-0.1, 0.1, 6)
"""Edges of the cells on the table."""


def rate_rows(sides: Sequence[Groups], width_in: float) -> Figure:
    """A row for each name with its rate, interval and number.

    Args:
        sides: columns of groups; a group has a heading, and a rate for each name.
        width_in: width of the figure (inches).
    """
    longest = max(sum(len(rates) + 1 for _, rates in side) for side in sides)
    figure = Figure(figsize=(width_in, 0.135 * longest + 0.7), layout="constrained")
    for axes, side in zip(figure.subplots(1, len(sides), squeeze=False)[0], sides, strict=True):
        _draw_rows(axes, side, longest)
    return figure


def _draw_rows(axes: Axes, groups: Groups, longest: int) -> None:
    y, ticks, labels = 0, [], []
    for heading, rates in groups:
        axes.text(-0.02, y, heading, ha="right", va="center", fontsize=7, fontweight="bold")
        axes.axhline(y, color="#e6e6e6", linewidth=0.8, zorder=0)
        y += 1
        for name, rate in rates.items():
            ticks.append(y)
            labels.append(plain_name(name))
            if rate.executed:
                axes.plot((rate.low, rate.high), (y, y), color=BLUE, linewidth=1.6, solid_capstyle="butt")
                axes.plot(rate.rate, y, "o", color="black", markersize=3)
            axes.text(1.02, y, f"{rate.lifted}/{rate.executed}", va="center", fontsize=6, color="#444444")
            y += 1
    axes.set_yticks(ticks, labels, fontsize=6.5)
    axes.tick_params(axis="y", length=0)
    axes.set(xlim=(0, 1), ylim=(longest - 0.5, -0.8))
    axes.xaxis.set_ticks(np.linspace(0, 1, 5), ["0", "25 %", "50 %", "75 %", "100 %"], fontsize=7)
    axes.tick_params(axis="x", top=True, labeltop=True)
    axes.grid(axis="x", color="#dddddd", linewidth=0.6)
    axes.spines[["left", "right"]].set_visible(False)


def in_columns(groups: Groups, columns: int) -> list[Groups]:
    """The groups in columns of about equal length; a group that does not fit goes on in the next."""
    most = -(-sum(len(rates) + 1 for _, rates in groups) // columns)
    sides: list[dict[str, dict[str, LiftRate]]] = [{}]
    for heading, rates in groups:
        for name, rate in rates.items():
            if len(sides) < columns and sum(len(own) + 1 for own in sides[-1].values()) >= most:
                sides.append({})
            sides[-1].setdefault(heading, {})[name] = rate
    return [list(side.items()) for side in sides]


def outcome_bars(grasps: pd.DataFrame, columns: Sequence[str]) -> Figure:
    """Shares of the outcomes in each group of grasps that share the values of the columns."""
    counts = grasps.groupby([*columns, "outcome"]).size().unstack(fill_value=0)
    names = [", ".join(plain_name(str(part)) for part in key) for key in counts.index]
    figure = Figure(figsize=(8, 0.42 * len(names) + 1.2), layout="constrained")
    axes = figure.subplots()
    left = np.zeros(len(names))
    total = counts.sum(axis=1).to_numpy(dtype=float)
    for outcome, fill in OUTCOME_FILLS.items():
        if outcome in counts:
            share = counts[outcome].to_numpy(dtype=float) / total
            axes.barh(names, share, left=left, label=outcome, edgecolor="#333333", linewidth=0.6, **fill)
            left += share
    for y, n in enumerate(total):
        axes.text(1.01, y, f"n = {n:.0f}", va="center", fontsize=8)
    axes.invert_yaxis()
    axes.set(xlim=(0, 1), xlabel="share of the planned grasps")
    figure.legend(loc="outside upper center", ncols=len(OUTCOME_FILLS), fontsize=8, frameon=False)
    return figure


def rates_over(grasps: pd.DataFrame, columns: Mapping[str, str], across: int) -> Figure:
    """Rate with interval over several numbers, a panel for each, overhead and side grasps apart.

    Args:
        grasps: rows of `grasp_frame`.
        columns: column -> name of the axis.
        across: panels side by side.
    """
    down = -(-len(columns) // across)
    figure = Figure(figsize=(2.5 * across, 2.1 * down + 0.4), layout="constrained")
    panels = figure.subplots(down, across, sharey=True, squeeze=False).ravel()
    for axes, (column, name) in zip(panels, columns.items(), strict=False):
        for grasp_type in reversed(GRASP_TYPES):
            own = grasps[grasps["grasp_type"] == grasp_type]
            _draw_bins(axes, binned_rates(own, column, BINS), grasp_type)
        axes.set_xlabel(name, fontsize=8)
        axes.set_ylim(0, 1)
        axes.tick_params(labelsize=7)
        axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.grid(color="#e3e3e3", linewidth=0.6)
    for axes in panels[len(columns) :]:
        axes.set_visible(False)
    figure.supylabel("lifted of executed", fontsize=9)
    handles = dict(zip(*reversed(panels[0].get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=2, frameon=False)
    return figure


def _draw_bins(axes: Axes, bins: Sequence[RateBin], grasp_type: str) -> None:
    if not bins:
        return
    rates = np.array([entry.rate.rate for entry in bins])
    low, high = (np.array([getattr(entry.rate, name) for entry in bins]) for name in ("low", "high"))
    axes.errorbar(
        [entry.mean for entry in bins],
        rates,
        yerr=np.maximum(0, (rates - low, high - rates)),
        label=f"{grasp_type} grasps",
        markersize=4,
        linewidth=1.2,
        elinewidth=0.8,
        capsize=2,
        **STYLES[grasp_type],
    )


def table_maps(grasps: pd.DataFrame) -> Figure:
    """Share of executed among planned grasps, and of lifted among executed, over the object's place."""
    places = ("object_x_m", "object_y_m")
    lifted, executed = gridded_counts(grasps, places, GRID_M)
    planned = gridded_counts(grasps.assign(executed=True), places, GRID_M)[1]
    figure = Figure(figsize=(8.4, 3.9), layout="constrained")
    pairs = (("executed of planned", executed, planned), ("lifted of executed", lifted, executed))
    for axes, (title, part, whole) in zip(figure.subplots(1, 2), pairs, strict=True):
        share = np.divide(part, whole, out=np.full_like(part, np.nan), where=whole > 0)
        extent = (GRID_M[0], GRID_M[-1], GRID_M[0], GRID_M[-1])
        image = axes.imshow(share.T, origin="lower", extent=extent, cmap="cividis")
        middles = (GRID_M[:-1] + GRID_M[1:]) / 2
        for (i, j), value in np.ndenumerate(share):
            text = f"{100 * value:.0f} %\n{whole[i, j]:.0f}" if whole[i, j] else "–"
            colour = "black" if image.norm(value) > 0.5 else "white"
            axes.text(middles[i], middles[j], text, ha="center", va="center", fontsize=7, color=colour)
        axes.set_title(title, fontsize=10)
        axes.set(xlabel="x (m), away from the robot", ylabel="y (m)")
        axes.set_xticks(GRID_M)
        axes.set_yticks(GRID_M)
        axes.tick_params(labelsize=8)
    return figure


def duration_histogram(grasps: pd.DataFrame) -> Figure:
    """Distribution of the physics' wall-clock time of executed trials, lifted and failed ones apart."""
    executed = grasps[grasps["executed"]]
    figure = Figure(figsize=(6.4, 2.6), layout="constrained")
    axes = figure.subplots()
    edges = np.linspace(0, float(executed["physics_s"].quantile(0.995)) if len(executed) else 1.0, 40)
    for name, own, style in (
        ("lifted", executed[executed["lifted"]], {"color": BLUE, "linestyle": "-"}),
        ("dropped or missed", executed[~executed["lifted"]], {"color": ORANGE, "linestyle": "--"}),
    ):
        axes.hist(own["physics_s"], bins=edges, histtype="step", linewidth=1.5, label=name, **style)
    axes.set(xlabel="physics of one trial (s of one core)", ylabel="trials")
    axes.legend(frameon=False, fontsize=8)
    return figure
