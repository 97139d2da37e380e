"""Every command starts from any directory."""

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
