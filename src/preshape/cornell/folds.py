"""Five folds of the images: at random, or by their objects."""

from collections import Counter
from collections.abc import Mapping

import numpy as np

from preshape.data.folds import FOLDS
from preshape.errors import InputError


def image_folds(objects: Mapping[int, int], seed: int) -> dict[int, int]:
    """Fold of every image, at random; the folds' sizes differ by one at most.

    All rectangles of an image are in its fold. Other images of its object may be in others: the image-wise
    split of the literature.

    Args:
        objects: object of each image, by the image's number.
        seed: of the shuffling.

    Raises:
        InputError: if there are fewer images than folds.
    """
    _check_enough(len(objects), "images")
    shuffled = np.random.default_rng(seed).permutation(sorted(objects))
    return {int(number): place % FOLDS for place, number in enumerate(shuffled)}


def object_folds(objects: Mapping[int, int], seed: int) -> dict[int, int]:
    """Fold of every image such that all images of an object are in the same one: the object-wise split.

    Objects are shuffled and then dealt, those with most images first, each to the fold with the fewest
    images, so that the folds' sizes differ by the images of one object at most.

    Args:
        objects: object of each image, by the image's number.
        seed: of the shuffling.

    Raises:
        InputError: if there are fewer objects than folds.
    """
    images = Counter(objects.values())
    _check_enough(len(images), "objects")
    shuffled = (int(number) for number in np.random.default_rng(seed).permutation(sorted(images)))
    sizes, fold_of = [0] * FOLDS, {}
    for object_id in sorted(shuffled, key=lambda number: -images[number]):
        fold_of[object_id] = int(np.argmin(sizes))
        sizes[fold_of[object_id]] += images[object_id]
    return {number: fold_of[object_id] for number, object_id in sorted(objects.items())}


def _check_enough(n: int, what: str) -> None:
    if n < FOLDS:
        raise InputError(
            f"{n} {what} cannot be dealt over {FOLDS} folds",
            where="Cornell data set",
            fix=f"give a data set with at least {FOLDS} {what}",
        )
