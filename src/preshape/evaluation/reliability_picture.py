"""The reliability diagram as a picture."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from preshape.evaluation.calibration import ReliabilityDiagram
from preshape.files import atomic_path


def save_reliability(path: str | Path, diagram: ReliabilityDiagram) -> None:
    """Draw predicted probability against the observed rate, with the number of trials below, atomically.

    Raises:
        InputError: if the place cannot be written to.
    """
    figure = Figure(figsize=(4.5, 5.2), layout="constrained")
    axes, counts = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    filled = diagram.count > 0
    predicted, observed = diagram.predicted[filled], diagram.observed[filled]
    error = np.abs(np.stack((observed - diagram.low[filled], diagram.high[filled] - observed)))
    axes.plot([0, 1], [0, 1], color="0.6", linestyle=":", label="calibrated")
    axes.errorbar(predicted, observed, error, fmt="o-", color="#0072B2", capsize=2, label="observed, 95 %")
    axes.set(
        ylabel="share that lifted",
        title=f"Expected calibration error {diagram.expected_error:.3f}",
        ylim=(0, 1),
    )
    axes.legend(loc="upper left")
    edges = np.linspace(0, 1, len(diagram.count) + 1)
    counts.bar(edges[:-1], diagram.count, np.diff(edges), align="edge", color="0.7", edgecolor="white")
    counts.set(xlabel="predicted probability of success", ylabel="trials", xlim=(0, 1))
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=150)
