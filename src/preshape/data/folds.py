"""Which trials are learned from, and which are held out."""

from collections import Counter
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


def split_trials(
    trials: TrialTable, scheme: SplitScheme, *, fold: int, validation_fraction: float, seed: int
) -> Split:
    """One of five folds of executed trials: about a fifth is the test set, with its share of successes.

    The validation trials come from the remaining ones and share no scene with the others, except under
    `SplitScheme.SEEN`.

    Args:
        trials: executed trials.
        scheme: what may be shared between the parts.
        fold: which fifth is held out, 0-4.
        validation_fraction: share of the remaining trials, to the nearest 1/n; 0 for none.
        seed: seed of the shuffling.

    Raises:
        InputError: if the fold does not exist, or there are too few trials, successes or objects.
    """
    if not 0 <= fold < FOLDS:
        raise InputError(f"There is no fold {fold}", where="fold", fix=f"choose one of 0 to {FOLDS - 1}")
    labels, scenes = trials.lifted, trials.scene_ids
    if scheme is SplitScheme.UNSEEN:
        test = _unseen_test(trials, fold)
    else:
        test = _stratified(labels, _groups(scheme, scenes), FOLDS, fold, seed)
    rest = np.flatnonzero(~test)
    test = np.flatnonzero(test)
    if validation_fraction <= 0:
        return Split(rest, np.array([], dtype=np.int64), test)
    parts = max(2, round(1 / validation_fraction))
    validation = _stratified(labels[rest], _groups(scheme, scenes[rest]), parts, 0, seed)
    return Split(rest[~validation], rest[validation], test)


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


def _groups(scheme: SplitScheme, scenes: Int[np.ndarray, "n"]) -> Int[np.ndarray, "n"] | None:
    return None if scheme is SplitScheme.SEEN else scenes


def _unseen_test(trials: TrialTable, fold: int) -> Bool[np.ndarray, "n"]:
    folds = object_folds(trials)
    return np.array([folds[name] == fold for name in trials.object_ids], dtype=bool)


def _stratified(
    labels: Bool[np.ndarray, "n"], groups: Int[np.ndarray, "n"] | None, folds: int, fold: int, seed: int
) -> Bool[np.ndarray, "n"]:
    """Mask of one of several folds of about the same share of successes; groups stay together."""
    scarce = min(int(labels.sum()), int((~labels).sum()))
    units = len(labels) if groups is None else len(np.unique(groups))
    if scarce < folds or units < folds:
        raise InputError(
            f"{labels.sum()} lifted and {(~labels).sum()} failed trials of {units} scenes "
            f"are too few for {folds} parts",
            where="trial table",
            fix="collect more trials with `python sim/collect.py`, or take dataset.validation_fraction=0",
        )
    kind = StratifiedKFold if groups is None else StratifiedGroupKFold
    splitter = kind(folds, shuffle=True, random_state=seed)
    members = [test for _, test in splitter.split(labels, labels, groups)][fold]
    mask = np.zeros(len(labels), dtype=bool)
    mask[members] = True
    return mask
