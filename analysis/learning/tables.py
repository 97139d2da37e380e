"""Tables of the results page about learning."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from analysis.learning.runs import LearningRun
from analysis.wording import table_row
from preshape.evaluation.decisions import PAPER_THRESHOLD

Runs = Mapping[tuple[str, str], LearningRun]
"""Runs by group and split."""
SPLITS = ("seen", "unseen")
PAPER_AUC = {"seen": "paper 0.83 ± 0.02", "unseen": "paper 0.82 ± 0.06"}
PAPER_DECISIONS = {"seen": ("0.766 (0.038)", "0.405 (0.016)"), "unseen": ("0.756 (0.05)", "0.385 (0.096)")}
"""Accuracy and F1 of config-CNN (paper, table 1)."""
PAPER_RANDOM = ("0.5", "0.172 (0.02)")
NOT_RUN = "*not run*"
NUMBERS = (150, 500, 1500, 5000)
"""Numbers of trials of the learning curves, besides all."""
WHEN = ("before", "after")
METRICS = {"auc": "AUC", "ap": "AP", "brier": "Brier", "ece": "ECE", "accuracy": "accuracy", "f1": "F1"}


def classification_lines(runs: Runs, networks: Mapping[str, str]) -> list[str]:
    """The paper's figures and ours, of networks that predict success.

    Args:
        runs: the sweeps.
        networks: groups by what is written beside them.
    """
    header = ["", "split", "folds", "n", "lifted", *METRICS.values(), "predicted to succeed"]
    rows = [_paper_row(split) for split in SPLITS]
    rows.append(["paper, random", "", "", "", "", "0.5", "", "", "", *PAPER_RANDOM, ""])
    for label, group in networks.items():
        rows += [_success_row(label, split, runs.get((group, split))) for split in SPLITS]
    rows += _baseline_rows(runs, list(networks.values()))
    note = (
        f"Accuracy, F1 and the share predicted to succeed are at a probability of {PAPER_THRESHOLD:g}. "
        "The paper's patches-CNN predicted that every grasp of its test fails."
    )
    return [*_table(header, rows), "", note]


def _paper_row(split: str) -> list[str]:
    accuracy, f1 = PAPER_DECISIONS[split]
    area = PAPER_AUC[split].removeprefix("paper ")
    return ["paper, config-CNN", split, "5", "1,507", "159", area, "", "", "", accuracy, f1, ""]


def _success_row(label: str, split: str, run: LearningRun | None) -> list[str]:
    if run is None:
        return [label, split, NOT_RUN, *[""] * (len(METRICS) + 3)]
    figures = run.figures()
    accepted = float(np.mean(run.predictions()[1] > PAPER_THRESHOLD))
    return [
        *(label, split, str(len(run.folds)), f"{figures['n']:,}", f"{figures['positives']:,}"),
        *(_spread(figures[name]) for name in METRICS),
        f"{accepted:.0%}",
    ]


def _baseline_rows(runs: Runs, groups: Sequence[str]) -> list[list[str]]:
    """What knows nothing, on the test trials of the network that was run on most folds."""
    known = [runs[group, split] for split in SPLITS for group in groups if (group, split) in runs]
    if not known:
        return []
    fullest = max(known, key=lambda run: len(run.folds))
    figures = fullest.figures()
    return [
        [
            *(f"{name} baseline", fullest.split, str(len(fullest.folds))),
            *(f"{figures['n']:,}", f"{figures['positives']:,}"),
            *(_spread(values[metric]) for metric in METRICS),
            "",
        ]
        for name, values in figures["baselines"].items()
    ]


def regression_lines(runs: Runs, group: str) -> list[str]:
    """Errors of the regression network beside the paper's."""
    header = [
        "",
        "split",
        "folds",
        "n",
        "palm, mean (m)",
        "palm, smallest (m)",
        "orientation (rad)",
        "joints (rad)",
    ]
    rows = [["paper", "", "", "", "above 0.4", "above 0.2", "far off", "far off"]]
    for split in SPLITS:
        run = runs.get((group, split))
        if run is None:
            rows.append(["regression, as in the paper", split, NOT_RUN, *[""] * 5])
            continue
        figures = run.figures()
        counts = [split, str(len(run.folds)), f"{figures['n']:,}"]
        rows.append(["regression, as in the paper", *counts, *_grasp_cells(figures)])
        for name, values in figures["baselines"].items():
            rows.append([f"{name} grasp, the mean of those learned from", *counts, *_grasp_cells(values)])
    note = (
        "Errors of held-out grasps that lifted; the smallest palm error is that of the best grasp of a fold."
    )
    return [*_table(header, rows), "", " ".join((note, *_collapses(runs, group)))]


def _collapses(runs: Runs, group: str) -> Iterator[str]:
    for split in SPLITS:
        run = runs.get((group, split))
        folds = [] if run is None else run.collapsed_folds()
        if folds:
            where = (
                f"{'fold' if len(folds) == 1 else 'folds'} {', '.join(map(str, folds))} of {split} objects"
            )
            yield f"In {where} the network says one grasp, whatever it sees."


def _grasp_cells(figures: Mapping[str, Any]) -> list[str]:
    names = ("palm_m", "palm_smallest_m", "orientation_rad", "joints_rad")
    return [_spread(figures[name]) for name in names]


def comparison_lines(runs: Runs, groups: Mapping[str, str]) -> list[str]:
    """Networks beside each other on unseen objects, and on seen ones.

    Args:
        runs: the sweeps.
        groups: their groups by what is written beside them.
    """
    metrics = ("auc", "ap", "brier", "ece")
    header = ["", *(f"{METRICS[name]}, {split}" for split in SPLITS for name in metrics)]
    rows = []
    for label, group in groups.items():
        cells = [label]
        for split in SPLITS:
            run = runs.get((group, split))
            figures = None if run is None else run.figures()
            missing = [NOT_RUN, *[""] * (len(metrics) - 1)]
            cells += missing if figures is None else [_spread(figures[name]) for name in metrics]
        rows.append(cells)
    return _table(header, rows)


def calibration_lines(runs: Runs, groups: Sequence[str]) -> list[str]:
    """Probabilities before and after temperature scaling on validation trials.

    Args:
        runs: the sweeps.
        groups: groups of networks that predict success.
    """
    header = ["", "split", "temperature", *(f"{name}, {when}" for name in ("Brier", "ECE") for when in WHEN)]
    rows = []
    for group in groups:
        for split in SPLITS:
            run = runs.get((group, split))
            figures = {} if run is None else run.figures()
            names = ("temperature", "brier_before_calibration", "brier", "ece_before_calibration", "ece")
            cells = [_spread(figures[name]) for name in names if name in figures]
            rows.append([group, split, *(cells or [NOT_RUN, *[""] * 4])])
    return _table(header, rows)


def learning_curve_lines(runs: Runs, sweeps: Mapping[str, Mapping[str, str]]) -> list[str]:
    """AUC, or the error of the palm, on the same test trials against the number of trials learned from.

    Args:
        runs: the sweeps.
        sweeps: by what is written beside them, the group with `all` trials and the beginning of the names of
            those with `fewer`.
    """
    header = ["", "split", *(f"{number:,}" for number in NUMBERS), "all"]
    rows = []
    for label, sweep in sweeps.items():
        for split in SPLITS:
            found = curve_runs(runs, sweep, split)
            if any(found) or split == "unseen":
                rows.append([label, split, *(_headline(run) for run in found)])
    note = "AUC; for the regression network the mean error of the palm (m). A row has the same test trials."
    return [*_table(header, rows), "", note]


def curve_groups(sweep: Mapping[str, str]) -> list[str]:
    """Groups of a learning curve, from few trials to all."""
    return [*(f"{sweep['fewer']},trials_learned={number}" for number in NUMBERS), sweep["all"]]


def curve_runs(runs: Runs, sweep: Mapping[str, str], split: str) -> list[LearningRun | None]:
    """Runs of a learning curve, from few trials to all, with the folds that all of them have: one test set.

    Args:
        runs: the sweeps.
        sweep: the group with `all` trials and the beginning of the names of those with `fewer`.
        split: how test trials were held out.
    """
    found = [runs.get((group, split)) for group in curve_groups(sweep)]
    known = [run for run in found if run is not None]
    shared = set.intersection(*(run.numbers for run in known)) if known else set()
    return [None if run is None or not shared else run.of_folds(shared) for run in found]


def headline(run: LearningRun) -> Mapping[str, Any]:
    """The figure that stands for a run: its AUC, or the error of the palm."""
    figures = run.figures()
    spread: Mapping[str, Any] = figures["auc"] if "auc" in figures else figures["palm_m"]
    return spread


def _headline(run: LearningRun | None) -> str:
    return NOT_RUN if run is None else _spread(headline(run))


def _spread(values: Mapping[str, Any]) -> str:
    """Mean and, of several folds, their standard deviation."""
    mean = f"{values['mean']:.3f}"
    return mean if len(values["folds"]) == 1 else f"{mean} ± {values['std']:.3f}"


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    rule = ["---", *["---:"] * (len(header) - 1)]
    return [table_row(*cells) for cells in (header, rule, *rows)]
