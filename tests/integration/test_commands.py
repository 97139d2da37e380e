"""Every command starts from any directory, and ends understandably while it does."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ready_python import ReadyPython

ROOT = Path(__file__).parents[2]
COMMANDS = [
    path.relative_to(ROOT)
    for folder in ("src", "sim", "analysis")
    for path in sorted((ROOT / folder).glob("*.py"))
    if "\n@entry_point(" in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("command", COMMANDS, ids=str)
def test_command_shows_its_configuration_anywhere(
    command: Path, ready_python: ReadyPython, tmp_path: Path
) -> None:
    shown = ready_python.run(ROOT / command, "--cfg", "job", cwd=tmp_path)
    assert shown.returncode == 0, shown.stderr
    assert "paths:" in shown.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["src/train.py", "sim/collect.py", "analysis/report.py", "src/doctor.py"])
def test_an_interrupt_while_libraries_are_imported_ends_in_one_line(command: str, tmp_path: Path) -> None:
    # Python tells of each import, and so when those of the script begin
    told = [sys.executable, "-X", "importtime", ROOT / command, "--cfg", "job"]
    kept = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    with subprocess.Popen(told, cwd=tmp_path, text=True, **kept) as starting:
        assert starting.stderr is not None
        begun = any("preshape.command_line.startup" in line for line in starting.stderr)
        time.sleep(0.2)
        starting.send_signal(signal.SIGINT)
        said = [line for line in starting.stderr if not line.startswith("import time:")]
    assert begun
    assert said == ["Interrupted.\n"]
    assert starting.returncode == 130
    assert list(tmp_path.iterdir()) == []
