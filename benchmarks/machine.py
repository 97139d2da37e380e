"""What the machine can do."""

import os
import time
from typing import Any

import torch

from preshape.provenance import processor_name

SIZE = 1536
RUNS = 8


def matrix_product_rate() -> float:
    """Floating point operations per second of single-precision matrix products, the best of several."""
    a, b = torch.rand(2, SIZE, SIZE, generator=torch.Generator().manual_seed(0)).unbind()
    best = float("inf")
    for _ in range(RUNS):
        start = time.perf_counter()
        a @ b
        best = min(best, time.perf_counter() - start)
    return 2 * SIZE**3 / best


def describe_machine() -> dict[str, Any]:
    """Processor, cores and threads."""
    return {"processor": processor_name(), "cores": os.cpu_count(), "threads": torch.get_num_threads()}
