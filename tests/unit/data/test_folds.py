"""Folds: every trial is tested once, and what must not leak does not."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from preshape.data.folds import FOLDS, HoldOut, Split, SplitScheme, object_folds, split_trials
from preshape.data.trial_table import TrialTable
from preshape.errors import InputError

TableMaker = Callable[..., TrialTable]
SCHEMES = tuple(scheme for scheme in SplitScheme if scheme is not SplitScheme.OBJECTS)
"""The splits that go through the table fold by fold."""


def splits(trials: TrialTable, scheme: SplitScheme, seed: int = 0) -> list[Split]:
    return [split_trials(trials, HoldOut(scheme, fold, 0.1, seed)) for fold in range(FOLDS)]


@pytest.fixture(scope="module")
def trials(table: TableMaker) -> TrialTable:
    return table(n_scenes=80, n_objects=13)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_trial_is_in_one_part_and_tested_once(trials: TrialTable, scheme: SplitScheme) -> None:
    tested: Counter[int] = Counter()
    for split in splits(trials, scheme):
        parts = np.concatenate((split.train, split.validation, split.test))
        assert sorted(parts.tolist()) == list(range(len(trials)))
        tested.update(split.test.tolist())
    assert tested == Counter(range(len(trials)))


@pytest.mark.parametrize("scheme", [SplitScheme.SCENES, SplitScheme.UNSEEN])
def test_no_scene_is_in_two_parts(trials: TrialTable, scheme: SplitScheme) -> None:
    for split in splits(trials, scheme):
        parts = [set(trials.scene_ids[part]) for part in (split.train, split.validation, split.test)]
        assert sum(map(len, parts)) == len(set.union(*parts))


def test_unseen_objects_are_never_learned_from(trials: TrialTable) -> None:
    objects = np.array(trials.object_ids)
    for split in splits(trials, SplitScheme.UNSEEN):
        assert set(objects[split.test]).isdisjoint(objects[split.train])
        assert set(objects[split.test]).isdisjoint(objects[split.validation])
        assert set(objects[split.train]).isdisjoint(objects[split.validation])


def test_named_objects_are_all_that_is_tested(trials: TrialTable) -> None:
    named = sorted(set(trials.object_ids))[2:5]
    split = split_trials(trials, HoldOut("objects", 0, 0.1, 0, named))
    objects = np.array(trials.object_ids)
    assert set(objects[split.test]) == set(named)
    assert set(objects[np.concatenate((split.train, split.validation))]).isdisjoint(named)
    parts = np.concatenate((split.train, split.validation, split.test))
    assert sorted(parts.tolist()) == list(range(len(trials)))


def test_objects_that_are_not_named_or_not_there_are_refused(trials: TrialTable) -> None:
    with pytest.raises(InputError, match="No objects are named"):
        HoldOut("objects", 0, 0.1, 0)
    with pytest.raises(InputError, match="teapot"):
        split_trials(trials, HoldOut("objects", 0, 0.1, 0, [trials.object_ids[0], "teapot"]))


@pytest.mark.parametrize("scheme", [SplitScheme.SCENES, SplitScheme.SEEN])
def test_folds_share_the_successes_evenly(trials: TrialTable, scheme: SplitScheme) -> None:
    rates = [trials.lifted[split.test].mean() for split in splits(trials, scheme)]
    assert rates == pytest.approx([trials.lifted.mean()] * FOLDS, abs=0.06)


def test_objects_are_dealt_in_snake_order(trials: TrialTable) -> None:
    folds = object_folds(trials)
    successes = Counter(trials.where(trials.lifted).object_ids)
    ordered = sorted(folds, key=lambda name: (-successes[name], name))
    assert [folds[name] for name in ordered] == [0, 1, 2, 3, 4, 4, 3, 2, 1, 0, 0, 1, 2]


def test_a_seed_decides_the_split(trials: TrialTable) -> None:
    first, again, other = (splits(trials, SplitScheme.SCENES, seed)[0] for seed in (0, 0, 1))
    assert np.array_equal(first.test, again.test)
    assert not np.array_equal(first.test, other.test)


def test_validation_can_be_left_out(trials: TrialTable) -> None:
    split = split_trials(trials, HoldOut("scenes", fold=0, validation_fraction=0.0, seed=0))
    assert len(split.validation) == 0
    assert len(split.train) + len(split.test) == len(trials)


@pytest.mark.parametrize(
    ("n_scenes", "n_objects", "rate", "scheme", "message"),
    [
        (40, 4, 0.3, SplitScheme.UNSEEN, "4 objects"),
        (40, 8, 0.0, SplitScheme.SCENES, "0 lifted and 120 failed"),
        (3, 3, 0.5, SplitScheme.SCENES, "in 3 groups"),
    ],
)
def test_tables_that_are_too_small_are_refused(
    table: TableMaker, n_scenes: int, n_objects: int, rate: float, scheme: SplitScheme, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        split_trials(table(n_scenes, n_objects, rate), HoldOut(scheme, 0, 0.1, 0))


@pytest.mark.parametrize(("split", "fold"), [("scenes", 5), ("seen", -1), ("all", 0)])
def test_unknown_splits_and_folds_are_refused(split: str, fold: int) -> None:
    with pytest.raises(InputError, match="There is no"):
        HoldOut(split, fold, validation_fraction=0.1, seed=0)
