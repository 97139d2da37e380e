"""Measure against other ways of doing the same, side by side: `python benchmarks/run.py`."""

import argparse
import logging
from pathlib import Path

from collection_speed import collection
from comparison import as_row
from machine import describe_machine, matrix_product_rate
from planning_speed import planning_comparisons
from rendering_speed import rendering
from training_speed import TRAINING_COMPARISONS

from preshape.files import write_json
from preshape.paths import project_root
from preshape.provenance import provenance

log = logging.getLogger("benchmarks")
SEED = 0


def main() -> None:
    """Run every comparison, one after the other, and write the result file."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=project_root() / "results" / "benchmarks.json")
    output = parser.parse_args().output
    rate = matrix_product_rate()
    log.info("Matrix products: %.1f GFLOP/s", rate / 1e9)
    rows = []
    for compare in (*planning_comparisons(), *TRAINING_COMPARISONS, collection, rendering):
        log.info("%s", comparison := compare(SEED, rate))
        rows.append(as_row(comparison))
    machine = describe_machine() | {"matrix_product_gflop_per_s": rate / 1e9}
    write_json(output, provenance(SEED) | {"machine": machine, "rows": rows})
    log.info("%d comparisons: %s", len(rows), output)


if __name__ == "__main__":
    main()
