"""How often the rectangle metric accepts labels, by the other labels of their image."""

from collections import Counter
from collections.abc import Iterable
from typing import Any

from preshape.cornell.data_set import CornellImage
from preshape.cornell.rectangle_metric import is_correct
from preshape.evaluation.intervals import wilson


def label_agreement(images: Iterable[CornellImage]) -> dict[str, dict[str, Any]]:
    """Share of labels that the other positives of their image make right, for `positives` and `negatives`.

    Where positives were drawn at random, as in `sim_cornell`, their share says how often a rectangle that
    lifts is found right; where people chose different ones, it says little. A positive that is alone in its
    image is left out. Negatives are what a detector must not return.
    """
    accepted: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    for image in images:
        for i, positive in enumerate(image.positives):
            others = image.positives[:i] + image.positives[i + 1 :]
            tried["positives"] += bool(others)
            accepted["positives"] += is_correct(positive, others)
        tried["negatives"] += len(image.negatives)
        accepted["negatives"] += sum(is_correct(own, image.positives) for own in image.negatives)
    figures = {}
    for name in ("positives", "negatives"):
        low, high = wilson(accepted[name], tried[name])
        rate = accepted[name] / tried[name] if tried[name] else float("nan")
        figures[name] = {"n": tried[name], "accepted": accepted[name], "rate": rate, "low": low, "high": high}
    return figures
