"""How many threads the network's arithmetic takes while planning."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch


@contextmanager
def one_thread() -> Iterator[None]:
    """Let torch compute in one thread, and in as many as before afterwards.

    The configuration head for a few grasps is microseconds of work per layer. Sharing that out costs more
    than it saves, and on a busy machine, where threads wait for each other, it is tens of times slower.
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
