"""Networks of an ablation against its first one, on the same trials."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.learning.runs import LearningRun
from analysis.learning.tables import SPLITS, Runs
from analysis.wording import table_row
from preshape.evaluation.decisions import PAPER_THRESHOLD
from preshape.evaluation.fold_summary import FoldResult
from preshape.evaluation.measured_files import PREDICTIONS_FILE, read_predictions
from preshape.evaluation.paired_metrics import Difference, PairedFold, paired_differences

SAME = ["trial_id", "scene_id", "lifted"]
"""In what two tables of predictions agree if they are of the same trials."""
COLUMNS = {"auc": "AUC", "brier": "Brier", "accuracy": "accuracy"}


@dataclass(frozen=True)
class AblationDifference:
    """A network against the first of its table, on the trials that both were tested with.

    Args:
        label, group, split: what the network is called in the table, its group and how trials were held out.
        reference: group of the first one.
        folds, n: numbers of the folds that both have, and how many test trials these have.
        figures: differences by figure.
    """

    label: str
    group: str
    split: str
    reference: str
    folds: Sequence[int]
    n: int
    figures: Mapping[str, Difference]

    def to_dict(self) -> dict[str, Any]:
        """As it stands in the result file."""
        about = {"group": self.group, "less": self.reference, "split": self.split}
        figures = {name: own.to_dict() for name, own in self.figures.items()}
        return {**about, "folds": list(self.folds), "n": self.n, **figures}


def ablation_differences(runs: Runs, groups: Mapping[str, str], seed: int) -> list[AblationDifference]:
    """Each network of a table less its first one, where both were run on the same trials.

    Args:
        runs: sweeps by group and split.
        groups: groups of the table by what is written beside them.
        seed: of the bootstrap.

    Raises:
        InputError: if a table of predictions cannot be read.
    """
    (_, reference), *others = groups.items()
    differences = []
    for label, group in others:
        for split in SPLITS:
            pairs = dict(_pairs(runs.get((group, split)), runs.get((reference, split))))
            if pairs:
                found = paired_differences(list(pairs.values()), np.random.default_rng(seed))
                n = sum(len(pair.lifted) for pair in pairs.values())
                about = (label, group, split, reference)
                differences.append(AblationDifference(*about, list(pairs), n, found))
    return differences


def _pairs(run: LearningRun | None, reference: LearningRun | None) -> Iterator[tuple[int, PairedFold]]:
    """The folds that both have, by their numbers."""
    if run is None or reference is None:
        return
    others = {fold.content["fold"]: fold for fold in reference.folds}
    for fold in run.folds:
        number = fold.content["fold"]
        pair = _pair(fold, others[number]) if number in others else None
        if pair is not None:
            yield number, pair


def _pair(first: FoldResult, second: FoldResult) -> PairedFold | None:
    """What both say of the same trials; None if they were tested with others, or do not say which."""
    one, two = (read_predictions(fold.folder / PREDICTIONS_FILE) for fold in (first, second))
    if not all({*SAME, "success_prob"} <= set(table) for table in (one, two)):
        return None
    if not one[SAME].equals(two[SAME]):
        return None
    scenes = np.unique(one["scene_id"].to_numpy(), return_inverse=True)[1]
    probabilities = (table["success_prob"].to_numpy(dtype=float) for table in (one, two))
    return PairedFold(one["lifted"].to_numpy(dtype=bool), *probabilities, scenes)


def difference_lines(differences: Sequence[AblationDifference]) -> list[str]:
    """A table of differences with their intervals, and what they are.

    Args:
        differences: of one table, at least one.
    """
    header = ["less that of the first row", "split", "folds", "n", *COLUMNS.values()]
    lines = [table_row(*header), table_row("---", *["---:"] * (len(header) - 1))]
    for own in differences:
        cells = (_cell(own.figures[name]) for name in COLUMNS)
        lines.append(table_row(own.label, own.split, len(own.folds), f"{own.n:,}", *cells))
    note = (
        "Differences on the same trials, mean over the folds, with 95 % bootstrap intervals over scenes; "
        f"accuracy at {PAPER_THRESHOLD:g}. Other seeds of the trainings are not in the intervals."
    )
    return [*lines, "", note]


def _cell(difference: Difference) -> str:
    if not difference.known:
        return "–"
    return f"{difference.value:+.3f} [{difference.low:+.3f}, {difference.high:+.3f}]"
