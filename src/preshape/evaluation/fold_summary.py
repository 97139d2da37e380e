"""Mean and standard deviation over the folds of a cross validation, and their average ROC curves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from preshape.evaluation.average_roc import AverageRoc, Fold, average_roc, average_roc_figure
from preshape.evaluation.measured_files import METRICS_FILE, PREDICTIONS_FILE, read_predictions
from preshape.files import atomic_path, exclusive, read_json, write_json
from preshape.provenance import provenance

SUMMARY_FILE = "summary.json"
ABOUT = ("model", "experiment", "trials", "trials_learned", "identity")
"""What a summary says about its folds."""


@dataclass(frozen=True)
class FoldResult:
    """A fold that came to its end.

    Args:
        folder: where its files lie.
        content: what its `metrics.json` says.
    """

    folder: Path
    content: Mapping[str, Any]

    @property
    def split(self) -> str:
        """How its test trials were held out."""
        return str(self.content["split"])

    @property
    def scalars(self) -> dict[str, float]:
        """Its figures; NaN where there is none."""
        scalars = self.content["scalars"].items()
        return {name: float("nan") if value is None else float(value) for name, value in scalars}

    def has(self, identity: Mapping[str, str]) -> bool:
        """Whether settings, data and code, as far as they are given, are those of the fold."""
        return identity.items() <= dict(self.content["identity"]).items()

    def predictions(self) -> Fold | None:
        """Outcomes and predicted probabilities of its test trials; None if it predicts no success.

        Raises:
            InputError: if the table of predictions cannot be read.
        """
        table = read_predictions(self.folder / PREDICTIONS_FILE)
        if "success_prob" not in table:
            return None
        return table["lifted"].to_numpy(dtype=bool), table["success_prob"].to_numpy(dtype=float)


@dataclass(frozen=True, eq=False)
class SweepSummary:
    """What the folds of a group came to, so far.

    Args:
        splits: figures of each split: `folds`, `n`, `positives`, and `metrics` with the mean, the standard
            deviation and the folds' values of each.
        files: the summary and its pictures.
    """

    splits: Mapping[str, Mapping[str, Any]]
    files: tuple[Path, ...]

    @property
    def folds(self) -> int:
        """Number of folds of all splits."""
        return sum(len(split["folds"]) for split in self.splits.values())

    def scalars(self) -> dict[str, float]:
        """Means and standard deviations by split and name: `seen_auc_mean`."""
        return {
            f"{split}_{name}_{part}": values[part]
            for split, figures in self.splits.items()
            for name, values in figures["metrics"].items()
            for part in ("mean", "std")
        }

    def in_words(self) -> str:
        """The AUC, or the error of the palm, of each split."""
        return ", ".join(_headline(split, figures) for split, figures in self.splits.items())


def finished_folds(group: str | Path, identity: Mapping[str, str] | None = None) -> list[FoldResult]:
    """The folds of a group that came to their end, by split and number.

    Args:
        group: folder with a folder for each fold.
        identity: digests of settings, data and perhaps code that the folds must have; None takes all.
    """
    results = [
        FoldResult(path.parent, read_json(path)) for path in sorted(Path(group).glob(f"*/{METRICS_FILE}"))
    ]
    wanted = [result for result in results if "fold" in result.content and result.has(identity or {})]
    return sorted(wanted, key=lambda result: (result.split, result.content["fold"]))


def summarise(group: Path, identity: Mapping[str, str]) -> SweepSummary:
    """Summarise the finished folds of a group in `summary.json` and a picture for each split.

    Several processes may do so at the same time.

    Args:
        group: folder with a folder for each fold.
        identity: digests of settings, data and perhaps code that the folds must have.

    Raises:
        InputError: if a file cannot be read or written.
    """
    with exclusive(group / ".summary.lock"):
        results = finished_folds(group, identity)
        splits = {name: split_figures(folds) for name, folds in by_split(results).items()}
        files = [group / SUMMARY_FILE]
        for name, folds in by_split(results).items():
            curve = split_roc(folds)
            if curve is not None:
                files.append(group / f"roc_{name}.png")
                figure = average_roc_figure({name: curve}, f"{group.name}: {name} objects")
                with atomic_path(files[-1]) as temporary:
                    figure.savefig(temporary, dpi=150)
        first = results[0].content
        about = {key: first.get(key) for key in ABOUT}
        write_json(
            files[0], {**provenance(int(first["seed"])), "group": group.name, **about, "splits": splits}
        )
    return SweepSummary(splits, tuple(files))


def by_split(results: Sequence[FoldResult]) -> dict[str, list[FoldResult]]:
    """The folds of each split, in order."""
    splits: dict[str, list[FoldResult]] = {}
    for result in results:
        splits.setdefault(result.split, []).append(result)
    return splits


def split_roc(folds: Sequence[FoldResult]) -> AverageRoc | None:
    """Average ROC curve of some folds; None if they predict no success."""
    predictions = [fold.predictions() for fold in folds]
    return average_roc([fold for fold in predictions if fold is not None])


def split_figures(folds: Sequence[FoldResult]) -> dict[str, Any]:
    """Figures of the folds of one split, as they stand in result files."""
    names = [name for name in folds[0].scalars if not name.endswith(("_low", "_high"))]
    return {
        "folds": [fold.content["fold"] for fold in folds],
        "n": sum(int(fold.scalars["n"]) for fold in folds),
        "positives": sum(int(fold.scalars.get("positives", fold.scalars["n"])) for fold in folds),
        "metrics": {name: _spread([fold.scalars[name] for fold in folds]) for name in names},
    }


def _spread(values: Sequence[float]) -> dict[str, Any]:
    return {"mean": float(np.mean(values)), "std": float(np.std(values)), "folds": list(values)}


def _headline(split: str, figures: Mapping[str, Any]) -> str:
    metrics, folds = figures["metrics"], len(figures["folds"])
    name, unit = ("auc", "") if "auc" in metrics else ("palm_m", " m")
    value = metrics[name]
    words = {"auc": "AUC", "palm_m": "palm off by"}[name]
    if folds == 1:
        return f"{split}: {words} {value['mean']:.3f}{unit} (1 fold)"
    return f"{split}: {words} {value['mean']:.3f} ± {value['std']:.3f}{unit} ({folds} folds)"
