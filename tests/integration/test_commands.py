"""Every command starts from any directory and refuses what it does not know."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
COMMANDS = [
    path.relative_to(ROOT)
    for folder in ("src", "sim", "analysis")
    for path in sorted((ROOT / folder).glob("*.py"))
    if "\n@entry_point(" in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("command", COMMANDS, ids=str)
def test_command_shows_its_configuration_anywhere(command: Path, tmp_path: Path) -> None:
    shown = subprocess.run(
        [sys.executable, ROOT / command, "--cfg", "job"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert shown.returncode == 0, shown.stderr
    assert "paths:" in shown.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", COMMANDS, ids=str)
def test_command_refuses_an_unknown_setting(command: Path, tmp_path: Path) -> None:
    refused = subprocess.run(
        [sys.executable, ROOT / command, "no_such_setting=1"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert refused.returncode == 2, refused.stderr
    assert "no_such_setting" in refused.stderr
    assert "Traceback" not in refused.stderr
