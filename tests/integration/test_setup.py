"""Setting up does what is needed, once."""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STAND_IN_FOR_PYTHON = """#!/bin/sh
if [ "$2" = pip ]; then echo "$*" >> {calls}; else exec {python} "$@"; fi
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """The scripts in a folder of their own; pip only writes down there what it was asked to do."""
    shutil.copytree(ROOT / "scripts", tmp_path / "scripts")
    (tmp_path / "requirements.lock").write_text("numpy==2.4.6\n")
    (tmp_path / "pyproject.toml").write_text("")
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(STAND_IN_FOR_PYTHON.format(calls=tmp_path / "calls", python=sys.executable))
    python.chmod(0o755)
    return tmp_path


def set_up(checkout: Path) -> list[str]:
    """What pip was asked to do by one run of the script."""
    (checkout / "calls").unlink(missing_ok=True)
    subprocess.run([checkout / "scripts" / "setup.sh"], check=True, stdin=subprocess.DEVNULL)
    calls = checkout / "calls"
    return re.findall(r"install .*(?=\n)", calls.read_text()) if calls.exists() else []


def test_second_setup_does_nothing_and_takes_seconds(checkout: Path) -> None:
    assert len(set_up(checkout)) == 2
    started = time.monotonic()
    assert set_up(checkout) == []
    assert time.monotonic() - started < 5


def test_only_what_changed_is_done_again(checkout: Path) -> None:
    set_up(checkout)
    (checkout / "requirements.lock").write_text("numpy==2.4.5\n")
    (lock_only,) = set_up(checkout)
    assert "--requirement requirements.lock" in lock_only
    (checkout / "pyproject.toml").write_text("# changed\n")
    (project_only,) = set_up(checkout)
    assert "--editable ." in project_only


def test_without_a_python_it_says_what_to_do(checkout: Path) -> None:
    shutil.rmtree(checkout / ".venv")
    (checkout / "scripts" / "system_packages.sh").write_text("#!/bin/bash\n")
    tools = checkout / "tools"
    tools.mkdir()
    for tool in ("bash", "dirname", "env"):
        (tools / tool).symlink_to(shutil.which(tool) or tool)
    done = subprocess.run(
        [checkout / "scripts" / "setup.sh"],
        env={"PATH": str(tools)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "make setup PYTHON=" in done.stderr


def test_make_help_lists_every_target() -> None:
    # Inside `make test` a second make would say which folder it enters.
    command = ["make", "--no-print-directory", "help"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
    assert {"setup", "demo", "test", "lint", "bench"} <= set(targets)
    assert [line.split()[1] for line in listed.splitlines()] == targets


@pytest.mark.parametrize(
    "script", [".ci/run", "scripts/setup.sh", "scripts/system_packages.sh", "scripts/lock.sh"]
)
def test_scripts_can_be_run(script: str) -> None:
    assert os.access(ROOT / script, os.X_OK)
    subprocess.run(["bash", "-n", ROOT / script], check=True)


def test_lock_is_exact_and_free_of_places() -> None:
    lines = [
        line for line in (ROOT / "requirements.lock").read_text().splitlines() if not line.startswith("#")
    ]
    assert [line for line in lines if not re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9._]+", line)] == []
