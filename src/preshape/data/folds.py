"""Which trials are learned from, and which are held out."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Int
from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

from preshape.data.trial_table import TrialTable
from preshape.errors import InputError

FOLDS = 5


class SplitScheme(StrEnum):
    """What a held-out trial has in common with the trials learned from."""

    SCENES = "scenes"
    """Its object, but not its scene."""
    SEEN = "seen"
    """Its object and perhaps its scene: the paper's random split."""
    UNSEEN = "unseen"
    """Neither scene nor object: the paper's split for novel objects."""
    OBJECTS = "objects"
    """Neither scene nor object, and the objects held out are named: the test objects of an experiment."""


@dataclass(frozen=True, eq=False)
class Split:
    """Row numbers of a table, each in exactly one part.

    Args:
        train: trials that the weights are fitted to.
        validation: trials by which training is watched; may be empty.
        test: trials that the figures are about.
    """

    train: Int[np.ndarray, "train"]
    validation: Int[np.ndarray, "validation"]
    test: Int[np.ndarray, "test"]


@dataclass(frozen=True)
class HoldOut:
    """What is held out of a table.

    Args:
        split: a `SplitScheme` by its value.
        fold: which fifth of the table is the test set, 0-4; without meaning if objects are named.
        validation_fraction: share of the remaining trials for validation, to the nearest 1/n; 0 for none.
        seed: seed of the shuffling.
        objects: names of the objects held out under `SplitScheme.OBJECTS`; without meaning otherwise.

    Raises:
        InputError: if there is no such split or fold, or objects should be held out and none is named.
    """

    split: str
    fold: int
    validation_fraction: float
    seed: int
    objects: Sequence[str] | None = None

    def __post_init__(self) -> None:
        schemes = [scheme.value for scheme in SplitScheme]
        if self.split not in schemes:
            raise InputError(
                f"There is no split {self.split!r}", where="split", fix=f"choose one of {', '.join(schemes)}"
            )
        if not 0 <= self.fold < FOLDS:
            fix = f"choose one of 0 to {FOLDS - 1}"
            raise InputError(f"There is no fold {self.fold}", where="fold", fix=fix)
        if self.split == SplitScheme.OBJECTS and not self.objects:
            fix = "name them with dataset.data.hold_out.objects=[...], or choose another split"
            raise InputError("No objects are named that could be held out", where="split=objects", fix=fix)


def split_trials(trials: TrialTable, hold_out: HoldOut) -> Split:
    """Split executed trials; the test set has about the whole table's share of successes.

    Validation trials have in common with those learned from what test trials have, so that training is ended,
    and the network calibrated, for what is tested.

    Raises:
        InputError: if there are too few trials, successes or objects, or a named object has no trials.
    """
    labels, seed = trials.lifted, hold_out.seed
    scheme = SplitScheme(hold_out.split)
    groups = _kept_together(trials, scheme)
    if scheme is SplitScheme.UNSEEN:
        folds = object_folds(trials)
        is_test = np.array([folds[name] == hold_out.fold for name in trials.object_ids], dtype=bool)
    elif scheme is SplitScheme.OBJECTS:
        is_test = _is_of_objects(trials, hold_out.objects or ())
    else:
        is_test = _stratified(labels, groups, FOLDS, hold_out.fold, seed)
    rest, test = np.flatnonzero(~is_test), np.flatnonzero(is_test)
    if hold_out.validation_fraction <= 0:
        return Split(rest, rest[:0], test)
    parts = max(2, min(round(1 / hold_out.validation_fraction), len(np.unique(groups[rest]))))
    is_validation = _stratified(labels[rest], groups[rest], parts, 0, seed)
    return Split(rest[~is_validation], rest[is_validation], test)


def _kept_together(trials: TrialTable, scheme: SplitScheme) -> Int[np.ndarray, "n"]:
    """Numbers that are equal for trials which must be in the same part."""
    if scheme is SplitScheme.SEEN:
        return np.arange(len(trials))
    if scheme is SplitScheme.SCENES:
        return trials.scene_ids
    return np.unique(trials.object_ids, return_inverse=True)[1]


def object_folds(trials: TrialTable) -> dict[str, int]:
    """Fold of every object: sorted by successes and dealt over the folds in snake order.

    So every fold gets as many objects and about as many successes as the others.

    Raises:
        InputError: if there are fewer objects than folds.
    """
    successes = Counter(dict.fromkeys(trials.object_ids, 0))
    successes.update(trials.where(trials.lifted).object_ids)
    if len(successes) < FOLDS:
        raise InputError(
            f"{len(successes)} objects cannot be dealt over {FOLDS} folds",
            where=f"split={SplitScheme.UNSEEN}",
            fix=f"collect trials with at least {FOLDS} objects, or choose split={SplitScheme.SCENES}",
        )
    ordered = sorted(successes, key=lambda name: (-successes[name], name))
    snake = [*range(FOLDS), *reversed(range(FOLDS))]
    return {name: snake[i % len(snake)] for i, name in enumerate(ordered)}


def _is_of_objects(trials: TrialTable, objects: Sequence[str]) -> Bool[np.ndarray, "n"]:
    unknown = sorted(set(objects) - set(trials.object_ids))
    if unknown:
        raise InputError(
            f"The table has no executed trial of {', '.join(unknown)}",
            where="dataset.data.hold_out.objects",
            fix="name objects that occur in its column object_id",
        )
    return np.isin(trials.object_ids, list(objects))


def _stratified(
    labels: Bool[np.ndarray, "n"], groups: Int[np.ndarray, "n"], folds: int, fold: int, seed: int
) -> Bool[np.ndarray, "n"]:
    """Mask of one of several folds of about the same share of successes; groups stay together."""
    scarce = min(int(labels.sum()), int((~labels).sum()))
    n_groups = len(np.unique(groups))
    if scarce < folds or n_groups < folds:
        raise InputError(
            f"{labels.sum()} lifted and {(~labels).sum()} failed trials in {n_groups} groups "
            f"are too few for {folds} parts",
            where="trial table",
            fix="collect more trials with `python sim/collect.py`, or leave validation out with "
            "dataset.hold_out.validation_fraction=0",
        )
    if n_groups == len(labels):
        splits = StratifiedKFold(folds, shuffle=True, random_state=seed).split(labels, labels)
    else:
        splits = StratifiedGroupKFold(folds, shuffle=True, random_state=seed).split(labels, labels, groups)
    mask = np.zeros(len(labels), dtype=bool)
    mask[[test for _, test in splits][fold]] = True
    return mask
