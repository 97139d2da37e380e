"""Two ways of doing the same, timed side by side."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from torch.utils.flop_counter import FlopCounterMode


@dataclass(frozen=True)
class Comparison:
    """How long our way takes, and another.

    Args:
        name: what is done.
        peer_name: the other way.
        ours_s, peer_s: median seconds of one run.
        bound_s: seconds below which ours cannot come.
        runs: how often each was run.
        details: further figures that the row has.
    """

    name: str
    peer_name: str
    ours_s: float
    peer_s: float
    bound_s: float
    runs: int
    details: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return (
            f"{self.name}: {1e3 * self.ours_s:.1f} ms, {self.peer_name}: {1e3 * self.peer_s:.1f} ms, "
            f"ratio {self.peer_s / self.ours_s:.1f}"
        )


def side_by_side(
    name: str,
    ours: Callable[[], object],
    peer_name: str,
    peer: Callable[[], object],
    runs: int,
    flop_per_s: float,
) -> Comparison:
    """Time two functions in turns, after a first run of each, so that both meet the same disturbances.

    The bound is the time that the arithmetic of ours takes at the rate of large matrix products.
    """
    with FlopCounterMode(display=False) as counter:
        ours()
    peer()
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(runs):
        for function, seconds in zip((ours, peer), times, strict=True):
            start = time.perf_counter()
            function()
            seconds.append(time.perf_counter() - start)
    medians = [statistics.median(seconds) for seconds in times]
    return Comparison(name, peer_name, *medians, counter.get_total_flops() / flop_per_s, runs)


def as_row(comparison: Comparison) -> dict[str, Any]:
    """The comparison as it stands in the result file.

    `ratio` says how many times faster ours is; `bound_share` is the bound as a share of the time that ours
    takes.
    """
    return {
        "name": comparison.name,
        "unit": "ms",
        "ours": 1e3 * comparison.ours_s,
        "peer": 1e3 * comparison.peer_s,
        "peer_name": comparison.peer_name,
        "ratio": comparison.peer_s / comparison.ours_s,
        "bound_share": comparison.bound_s / comparison.ours_s,
        "runs": comparison.runs,
        **comparison.details,
    }
