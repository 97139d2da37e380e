"""What is learned from, watched and tested: five folds of the images, or the images of named objects."""

import logging
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from preshape.data.folds import FOLDS, HoldOut, SplitScheme
from preshape.errors import InputError

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ImageSplit:
    """Numbers of images, each in exactly one part.

    Args:
        train: images that the weights are fitted to.
        validation: images by which training is watched; may be empty.
        test: images that the figures are about.
    """

    train: frozenset[int]
    validation: frozenset[int]
    test: frozenset[int]


def split_images(objects: Mapping[int, int], names: Mapping[int, str], hold_out: HoldOut) -> ImageSplit:
    """Split images: image-wise (`SplitScheme.SCENES`), object-wise (`UNSEEN`), or by name (`OBJECTS`).

    Validation images have in common with those learned from what test images have.

    Args:
        objects: object of each image, by the image's number.
        names: name of each image's object, by the image's number.
        hold_out: what is held out.

    Raises:
        InputError: if another split is asked for, there are too few images or objects, or no image shows an
            object that is named.
    """
    deal = image_folds if hold_out.split == SplitScheme.SCENES else object_folds
    test = _tested(objects, names, hold_out)
    rest = {number: own for number, own in objects.items() if number not in test}
    validation: frozenset[int] = frozenset()
    if hold_out.validation_fraction > 0:
        part_of = deal(rest, hold_out.seed, max(2, round(1 / hold_out.validation_fraction)))
        validation = frozenset(number for number, part in part_of.items() if part == 0)
    return ImageSplit(frozenset(rest) - validation, validation, test)


def _tested(objects: Mapping[int, int], names: Mapping[int, str], hold_out: HoldOut) -> frozenset[int]:
    """Numbers of the images that are held out."""
    deals = {SplitScheme.SCENES: image_folds, SplitScheme.UNSEEN: object_folds}
    scheme = SplitScheme(hold_out.split)
    if scheme is SplitScheme.OBJECTS:
        return _showing(names, frozenset(hold_out.objects or ()))
    if scheme not in deals:
        raise InputError(
            f"The Cornell data set has no split {hold_out.split!r}",
            where="split",
            fix="choose split=scenes (image-wise), split=unseen (object-wise) or split=objects",
        )
    fold_of = deals[scheme](objects, hold_out.seed)
    return frozenset(number for number, fold in fold_of.items() if fold == hold_out.fold)


def _showing(names: Mapping[int, str], wanted: frozenset[str]) -> frozenset[int]:
    """Images of some objects. An object without an image is held out anyhow, but it may be misspelt."""
    lacking = sorted(wanted - set(names.values()))
    if len(lacking) == len(wanted):
        raise InputError(
            f"No image shows {', '.join(lacking)}",
            where="dataset.data.hold_out.objects",
            fix=f"name some of {', '.join(sorted(set(names.values())))}",
        )
    if lacking:
        log.warning("Held out, but in no image: %s", ", ".join(lacking))
    return frozenset(number for number, name in names.items() if name in wanted)


def image_folds(objects: Mapping[int, int], seed: int, folds: int = FOLDS) -> dict[int, int]:
    """Fold of every image, at random; the folds' sizes differ by one at most.

    All rectangles of an image are in its fold. Other images of its object may be in others: the image-wise
    split of the literature.

    Args:
        objects: object of each image, by the image's number.
        seed: of the shuffling.
        folds: how many there are.

    Raises:
        InputError: if there are fewer images than folds.
    """
    _check_enough(len(objects), "images", folds)
    shuffled = np.random.default_rng(seed).permutation(sorted(objects))
    return {int(number): place % folds for place, number in enumerate(shuffled)}


def object_folds(objects: Mapping[int, int], seed: int, folds: int = FOLDS) -> dict[int, int]:
    """Fold of every image such that all images of an object are in the same one: the object-wise split.

    Objects are shuffled and then dealt, those with most images first, each to the fold with the fewest
    images, so that the folds' sizes differ by the images of one object at most.

    Args:
        objects: object of each image, by the image's number.
        seed: of the shuffling.
        folds: how many there are.

    Raises:
        InputError: if there are fewer objects than folds.
    """
    images = Counter(objects.values())
    _check_enough(len(images), "objects", folds)
    shuffled = (int(number) for number in np.random.default_rng(seed).permutation(sorted(images)))
    sizes, fold_of = [0] * folds, {}
    for object_id in sorted(shuffled, key=lambda number: -images[number]):
        fold_of[object_id] = int(np.argmin(sizes))
        sizes[fold_of[object_id]] += images[object_id]
    return {number: fold_of[object_id] for number, object_id in sorted(objects.items())}


def _check_enough(n: int, what: str, folds: int) -> None:
    if n < folds:
        raise InputError(
            f"{n} {what} cannot be dealt over {folds} folds",
            where="Cornell data set",
            fix=f"give a data set with at least {folds} {what}",
        )
