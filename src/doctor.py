"""Check what commonly goes wrong on a machine, and name the fix: `python src/doctor.py`."""

import preshape.command_line.startup

import logging
import sys

if sys.version_info < (3, 11):  # noqa: UP036 - whoever calls a doctor may have the wrong Python
    sys.exit(
        "FAIL  Python: 3.11 or 3.12 is needed\n      fix: make setup, then .venv/bin/python src/doctor.py"
    )

from preshape.health.checkup import all_checks, run_checks
from preshape.paths import project_root


def main() -> None:
    """Tell what every check found; exit with status 1 if one failed."""
    logging.basicConfig(format="%(message)s", level=logging.INFO, stream=sys.stdout)
    sys.exit(0 if run_checks(all_checks(project_root())) else 1)


if __name__ == "__main__":
    main()
