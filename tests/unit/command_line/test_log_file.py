"""A log file that cannot be written says so once, and the run goes on."""

import logging
from pathlib import Path

import pytest

from preshape.command_line.log_file import LogFile

FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="only Linux has a file that is always full")
def test_a_full_disk_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    log, handler = logging.Logger("full"), LogFile(FULL)
    log.addHandler(handler)
    for number in range(3):
        log.warning("record %d", number)
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "No space left on device (/dev/full)" in said


def test_records_are_written(tmp_path: Path) -> None:
    log, handler = logging.Logger("fine"), LogFile(tmp_path / "run.log")
    log.addHandler(handler)
    log.warning("record %d", 1)
    handler.close()
    assert (tmp_path / "run.log").read_text() == "record 1\n"


def test_a_defect_in_a_record_keeps_its_traceback(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, handler = logging.Logger("wrong"), LogFile(tmp_path / "run.log")
    log.addHandler(handler)
    log.warning("record %d", "one")
    log.warning("record %d", 2)
    assert "TypeError" in capsys.readouterr().err
    handler.close()
    assert (tmp_path / "run.log").read_text() == "record 2\n"
