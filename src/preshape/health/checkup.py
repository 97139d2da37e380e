"""All checks, and how their findings are told."""

import logging
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from preshape.health import environment, graphics, storage
from preshape.health.finding import Check, Finding, Status

log = logging.getLogger(__name__)


def all_checks(root: Path) -> list[Check]:
    """Every check of the project whose checkout is `root`."""
    return [
        environment.check_python,
        partial(environment.check_packages, root / "requirements.lock"),
        environment.check_torch,
        graphics.check_open3d,
        graphics.check_vulkan,
        graphics.check_simulator,
        environment.check_robot_data,
        partial(storage.check_shipped_table, root / "data" / "allegro_grocery"),
        partial(storage.check_mlflow_store, root / "mlflow.db", os.environ.get("MLFLOW_TRACKING_URI")),
        partial(storage.check_disk, root),
    ]


def run_checks(checks: Sequence[Check]) -> bool:
    """Run the checks side by side, log what they found in their order, and say whether nothing failed."""
    with ThreadPoolExecutor() as pool:
        findings = list(_tell(pool.map(lambda check: check(), checks)))
    count = Counter(finding.status for finding in findings)
    log.info(
        "%d checks: %d fine, %d warnings, %d failed",
        len(findings),
        count[Status.OK],
        count[Status.WARN],
        count[Status.FAIL],
    )
    return count[Status.FAIL] == 0


def _tell(findings: Iterable[Finding]) -> Iterable[Finding]:
    for finding in findings:
        log.info("%-4s  %s: %s", finding.status, finding.name, finding.detail)
        if finding.fix:
            log.info("      fix: %s", finding.fix)
        yield finding
