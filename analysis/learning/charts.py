"""Charts about learning, readable without colour: every series has its own mark or line as well."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.learning.runs import LearningRun
from analysis.learning.tables import NUMBERS, SPLITS, curve_runs, headline
from preshape.evaluation.calibration import reliability_diagram
from preshape.evaluation.measured_files import CURVES_FILE, read_figures

CAPTIONS = {
    "reliability": "Predicted probability against the share that lifted, all folds together",
    "training_curves": "Loss over the iterations of each fold: training and, where there is one, validation",
    "learning_curves": "AUC on held-out trials against the number of trials learned from",
}
STYLES = (("#0072b2", "o", "-"), ("#b24a00", "s", "--"), ("#117733", "^", "-."), ("#767676", "D", ":"))


def reliability_charts(runs: Sequence[LearningRun]) -> Figure:
    """A reliability diagram of each run, over the test trials of all its folds."""
    figure = Figure(figsize=(3.2 * len(runs), 3.4), layout="constrained")
    for axes, run in zip(figure.subplots(1, len(runs), squeeze=False)[0], runs, strict=True):
        diagram = reliability_diagram(*run.predictions())
        filled = diagram.count > 0
        observed = diagram.observed[filled]
        error = np.abs(np.stack((observed - diagram.low[filled], diagram.high[filled] - observed)))
        axes.plot([0, 1], [0, 1], color="0.6", linestyle=":")
        axes.errorbar(diagram.predicted[filled], observed, error, fmt="o-", color="#0072b2", capsize=2)
        axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="predicted", ylabel="lifted")
        axes.set_title(f"{run.group}, {run.split}\nECE {diagram.expected_error:.3f}", fontsize=8)
    return figure


def training_curves(runs: Sequence[LearningRun]) -> Figure:
    """Losses of each fold of each run over the iterations."""
    figure = Figure(figsize=(3.6 * len(runs), 3.0), layout="constrained")
    for axes, run in zip(figure.subplots(1, len(runs), squeeze=False)[0], runs, strict=True):
        for fold in run.folds:
            points = read_figures(fold.folder / CURVES_FILE, "points")["points"]
            _draw_loss(axes, points, "train_loss", "#767676", "-")
            _draw_loss(axes, points, "val_loss", "#0072b2", "--")
        axes.set(xlabel="iteration", ylabel="cross entropy")
        axes.set_title(f"{run.group}, {run.split}\ngrey: training, blue dashes: validation", fontsize=8)
    return figure


def _draw_loss(axes: Axes, points: Sequence[Mapping[str, float]], name: str, colour: str, line: str) -> None:
    known = [(point["iteration"], point[name]) for point in points if name in point]
    if known:
        axes.plot(*zip(*known, strict=True), color=colour, linestyle=line, linewidth=0.8)


def learning_curves(
    runs: Mapping[tuple[str, str], LearningRun], sweeps: Mapping[str, Mapping[str, str]]
) -> Figure | None:
    """AUC against the number of trials; None if no network that predicts success has two points."""
    curves = {}
    for label, sweep in sweeps.items():
        for split in SPLITS:
            found = curve_runs(runs, sweep, split)
            sizes = [*NUMBERS, _all_trials(found[-1])]
            points = [
                (size, *(headline(run)[part] for part in ("mean", "std")))
                for size, run in zip(sizes, found, strict=True)
                if run is not None and "auc" in run.figures()
            ]
            if len(points) > 1:
                curves[f"{label}, {split}"] = points
    if not curves:
        return None
    figure = Figure(figsize=(5.5, 4.0), layout="constrained")
    axes = figure.subplots()
    for number, (label, points) in enumerate(curves.items()):
        colour, marker, line = STYLES[number % len(STYLES)]
        sizes, mean, std = zip(*points, strict=True)
        axes.errorbar(sizes, mean, std, color=colour, marker=marker, linestyle=line, capsize=2, label=label)
    axes.set(xscale="log", xlabel="trials", ylabel="AUC")
    axes.set_xticks([*NUMBERS, 10000], [f"{number:,}" for number in (*NUMBERS, 10000)])
    axes.minorticks_off()
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.legend(fontsize=8)
    return figure


def _all_trials(run: LearningRun | None) -> int:
    """Size of the whole table: over all folds, every trial is tested once."""
    if run is None:
        return 0
    return round(run.figures()["n"] / len(run.folds) * 5)
