"""Folds are disjoint, even and seeded, and keep objects together where they should."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from preshape.cornell.folds import image_folds, object_folds, split_images
from preshape.data.folds import HoldOut
from preshape.errors import InputError

objects = st.dictionaries(st.integers(0, 1034), st.integers(0, 30), min_size=5, max_size=80)


@given(objects, st.integers(0, 99))
def test_image_folds_are_even_and_hold_every_image_once(images: dict[int, int], seed: int) -> None:
    folds = image_folds(images, seed)
    sizes = Counter(folds.values())
    assert set(folds) == set(images)
    assert set(sizes) == set(range(5))
    assert max(sizes.values()) - min(sizes.values()) <= 1
    assert folds == image_folds(images, seed)


@given(objects.filter(lambda images: len(set(images.values())) >= 5), st.integers(0, 99))
def test_object_folds_never_split_an_object(images: dict[int, int], seed: int) -> None:
    folds = object_folds(images, seed)
    assert set(folds) == set(images)
    of_object: dict[int, set[int]] = {}
    for number, object_id in images.items():
        of_object.setdefault(object_id, set()).add(folds[number])
    assert all(len(own) == 1 for own in of_object.values())
    sizes = Counter(folds.values())
    assert set(sizes) == set(range(5))
    assert max(sizes.values()) - min(sizes.values()) <= max(Counter(images.values()).values())
    assert folds == object_folds(images, seed)


@pytest.mark.parametrize("deal", [image_folds, object_folds])
def test_another_seed_deals_otherwise(deal: type) -> None:
    images = {number: number // 4 for number in range(100)}
    assert deal(images, 0) != deal(images, 1)


def test_too_few_to_deal_are_refused() -> None:
    with pytest.raises(InputError, match="4 images"):
        image_folds(dict.fromkeys(range(4), 1), 0)
    with pytest.raises(InputError, match="1 objects"):
        object_folds(dict.fromkeys(range(40), 1), 0)


def test_named_objects_are_held_out_whole(caplog: pytest.LogCaptureFixture) -> None:
    images = {number: number // 3 for number in range(30)}
    names = {number: f"object_{own}" for number, own in images.items()}
    named = HoldOut("objects", 0, 0.2, 0, objects=("object_2", "object_7", "lifted_by_nobody"))
    split = split_images(images, names, named)
    assert split.test == {6, 7, 8, 21, 22, 23}
    assert split.train | split.validation | split.test == set(images)
    assert not split.train & split.validation
    assert not {images[n] for n in split.train} & {images[n] for n in split.validation}
    assert "lifted_by_nobody" in caplog.text
    with pytest.raises(InputError, match="teapot"):
        split_images(images, names, HoldOut("objects", 0, 0.0, 0, objects=("teapot",)))
