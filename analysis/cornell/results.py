"""Recognition and detection in images as a section of the results page."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.wording import plain_name, table_row
from preshape.cornell.protocols import PROTOCOLS

SECTION = "two_finger_images"
DATA = {
    "cornell": "Real images of the Cornell data",
    "cornell_from_sim": "The same, learned on from `sim_cornell`",
    "sim_cornell": "Simulated images, `sim_cornell`",
}
SHOWN = {
    "recognition_accuracy": "recognition: accuracy",
    "recognition_auc": "recognition: AUC",
    "detection_inference_1": "detection: inference from 1 initial rectangle",
    "detection_inference_4": "detection: inference from 4, as in the paper",
    "detection_inference_64": "detection: inference from 64",
    "detection_max_eval_4": "detection: max-eval, best of 4 initial rectangles",
    "detection_max_eval_64": "detection: max-eval, best of 64",
    "detection_grid": "detection: best of an exhaustive grid",
    "detection_random_1": "detection: one initial rectangle at random",
}
PAPER = {
    "recognition_accuracy": "as Lenz et al. 2015: 93.7 %",
    "detection_inference_4": "84 %, executed",
    "detection_random_1": "40 %, executed",
}
"""What the paper says of its network on the Cornell data, and of rectangles executed by a robot."""
CORRECTED = ("detection_inference_1", "detection_inference_4", "detection_inference_64")
AREAS = ("recognition_auc",)
HEAD = (
    "Made by `python analysis/report.py report=cornell`; five folds each. Intervals are 95 %: bootstrap over "
    "images for recognition, Wilson for detection. A rectangle is right if the rectangle metric accepts it.\n"
    "The paper's network recognises labelled rectangles about as well as that of Lenz et al. Its "
    "own rectangles were executed by a robot, which asks more of them than to be right in an image."
)
CORRECTIONS = (
    "Mean probability that the network gives the rectangle at which inference ends, and Brier score: as it "
    "says, and corrected by the optima in the images of the other four folds."
)

Rows = Sequence[Mapping[str, Any]]


def results_section(rows: Rows, file: str) -> str:
    """Markdown of the section: each data set with both protocols, and what networks say of their own optima.

    Args:
        rows: of the result file.
        file: the result file.
    """
    named = list(dict.fromkeys(row["data"] for row in rows))
    order = [*(name for name in DATA if name in named), *(name for name in named if name not in DATA)]
    parts = [["## Two fingers: rectangles in images"], [f"From `{Path(file).name}`. {HEAD}"]]
    for name in order:
        own = {(row["folds"], row["metric"]): row for row in rows if row["data"] == name}
        parts += [[f"### {DATA.get(name, plain_name(name))}"], [_made(own.values())], _table(own)]
    corrected = [row for row in rows if row.get("corrected") and row["metric"] in CORRECTED]
    if corrected:
        parts += [
            ["### What the network says of its own optima"],
            [CORRECTIONS],
            _corrections(corrected),
        ]
    return "\n\n".join("\n".join(part) for part in parts)


def _made(rows: Iterable[Mapping[str, Any]]) -> str:
    made = dict.fromkeys(f"`{row['command']}` at revision `{row['git_revision']}`" for row in rows)
    return f"Made by {', '.join(made)}."


def _table(own: Mapping[tuple[str, str], Mapping[str, Any]]) -> list[str]:
    said = [name.replace("_", "-") for name in PROTOCOLS.values()]
    lines = [table_row("", *said, "paper"), "|---|---|---|---|"]
    for metric, words in SHOWN.items():
        cells = [_cell(own.get((folds, metric)), metric) for folds in PROTOCOLS.values()]
        if any(cells):
            lines.append(table_row(words, *(cell or "not run" for cell in cells), PAPER.get(metric, "–")))
    return lines


def _cell(row: Mapping[str, Any] | None, metric: str) -> str:
    """`77 % [65, 86] of 60`."""
    if row is None:
        return ""
    if metric in AREAS:
        return f"{row['value']:.3f} [{row['low']:.3f}, {row['high']:.3f}]"
    value, low, high = (100 * row[key] for key in ("value", "low", "high"))
    return f"{value:.0f} % [{low:.0f}, {high:.0f}] of {row['n']:,}"


def _corrections(rows: Rows) -> list[str]:
    lines = [
        table_row(
            "data", "folds", "inference from", "right", "said", "temperature scaling", "isotonic regression"
        ),
        "|---|---|---:|---:|---|---|---|",
    ]
    for row in rows:
        starts = row["metric"].rpartition("_")[2]
        corrected = (_said(row["corrected"][name]) for name in ("temperature", "isotonic"))
        head = (row["data"], plain_name(row["folds"]).replace(" ", "-"), starts, f"{row['value']:.2f}")
        lines.append(table_row(*head, _said(row), *corrected))
    return lines


def _said(row: Mapping[str, Any]) -> str:
    if row["predicted"] is None:
        return "–"
    return f"{row['predicted']:.2f} (Brier {row['brier']:.3f})"
