"""The protocols of the Cornell data as tables and pictures: recognition, and detection by several methods."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from analysis.cornell.sheet import ACROSS, draw_rectangle, show_around
from analysis.cornell.surfaces import spread
from analysis.dataset.charts import BLUE, ORANGE
from analysis.wording import table_row
from preshape.cornell.data_set import CornellDataSet
from preshape.cornell.image_files import read_colour
from preshape.cornell.protocols import DETECTIONS_FILE, PROTOCOLS
from preshape.cornell.rectangle import GraspRectangle
from preshape.evaluation.average_roc import average_roc_figure
from preshape.evaluation.fold_summary import by_split, finished_folds, split_roc
from preshape.evaluation.measured_files import read_figures

PUBLISHED = {
    "Lenz et al. 2015": ("73.9", "75.6"),
    "Redmon and Angelova 2015": ("88.0", "87.1"),
    "Kumra and Kanan 2017": ("89.2", "89.0"),
    "Morrison et al. 2018 (GG-CNN)": ("73.0", "69.0"),
    "Kumra et al. 2020 (GR-ConvNet)": ("97.7", "96.6"),
}
"""Detection accuracies image-wise and object-wise (%), learned from 885 images."""
GREEN = "#117733"
SHOWN_METHOD = "inference"
SHOWN_STARTS = 4


def protocol_table(rows: Sequence[Mapping[str, Any]], name: str) -> list[str]:
    """Lines of Markdown: the rows of the result file for one data set, image-wise beside object-wise."""
    own = {(row["folds"], row["metric"]): row for row in rows if row["data"] == name}
    if not own:
        return ["Nobody has run `python src/detect.py` yet."]
    metrics = list(dict.fromkeys(metric for _, metric in own))
    head = [table_row("figure", *(one.replace("_", "-") for one in PROTOCOLS.values())), "|---|---|---|"]
    lines = [
        table_row(
            metric.replace("_", " "), *(_cell(own.get((folds, metric))) for folds in PROTOCOLS.values())
        )
        for metric in metrics
    ]
    published = [table_row(f"detection, {who}", *accuracies) for who, accuracies in PUBLISHED.items()]
    return [*head, *lines, *published]


def _cell(row: Mapping[str, Any] | None) -> str:
    if row is None:
        return "not run"
    if row["low"] is None:
        return f"{row['value']:.3f} (n = {row['n']})"
    return f"{row['value']:.3f} [{row['low']:.3f}, {row['high']:.3f}] (n = {row['n']})"


def recognition_roc(runs: Path) -> Figure | None:
    """Average ROC curves of the folds of both protocols; None if none was trained."""
    curves = {
        PROTOCOLS[split].replace("_", "-"): split_roc(folds)
        for split, folds in by_split(finished_folds(runs)).items()
        if split in PROTOCOLS
    }
    known = {name: curve for name, curve in curves.items() if curve is not None}
    return average_roc_figure(known, "recognition of labelled rectangles") if known else None


def detection_sheet(data: CornellDataSet, runs: Path, shown: int) -> Figure | None:
    """Figure of images with what inference proposed before and after; None if nothing was detected.

    Object-wise folds are shown if they are there. Thick edges are the jaws.
    """
    planned = _detections(runs, SHOWN_METHOD)
    given = _detections(runs, "max_eval")
    images = spread([image for image in data.images if image.files.number in planned], shown)
    if not images:
        return None
    down = -(-len(images) // ACROSS)
    figure = Figure(figsize=(ACROSS * 3.4, down * 2.8 + 0.4), layout="constrained")
    for axes, image in zip(figure.subplots(down, ACROSS, squeeze=False).flat, images, strict=False):
        number = image.files.number
        axes.imshow(read_colour(image.files.colour))
        for rectangle in image.positives:
            draw_rectangle(axes, rectangle, BLUE, 0.5)
        for found, colour in ((given, ORANGE), (planned, GREEN)):
            draw_rectangle(axes, GraspRectangle(**found[number]["rectangle"]), colour, 1.6)
        show_around(axes, [*image.positives, GraspRectangle(**planned[number]["rectangle"])])
        verdict = "right" if planned[number]["correct"] else "wrong"
        axes.set_title(f"{number:04d} p {planned[number]['success_prob']:.2f}, {verdict}", fontsize=9)
    _finish(figure.axes, figure)
    return figure


def _finish(all_axes: Sequence[Axes], figure: Figure) -> None:
    for axes in all_axes:
        axes.set_axis_off()
    names = ((BLUE, "labelled positive"), (ORANGE, "best initial rectangle"), (GREEN, "inference"))
    legend = [Patch(color=colour, label=name) for colour, name in names]
    figure.legend(handles=legend, loc="outside lower center", ncols=3, frameon=False)


def _detections(runs: Path, method: str) -> dict[int, dict[str, Any]]:
    """What a method proposed from four starts, by image; of object-wise folds where there are such."""
    found: dict[int, dict[str, Any]] = {}
    for path in sorted(runs.glob(f"*/{DETECTIONS_FILE}")):  # `unseen` comes after `scenes`, and stays
        for own in read_figures(path, "detections")["detections"]:
            if (own["method"], own["starts"]) == (method, SHOWN_STARTS):
                found[int(own["image"])] = own
    return found
