"""The doctor sees what is broken and names the fix."""

import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from preshape.health import environment, graphics, storage
from preshape.health.checkup import run_checks
from preshape.health.finding import Finding, ProbeResult, Status, probe

ROOT = Path(__file__).parents[3]
OLD_MESA = '[{"name": "llvmpipe", "driver": "llvmpipe", "version": "Mesa 22.3.6 (LLVM 15.0.6)"}]'
OLD_MESA_AND_CARD = OLD_MESA[:-1] + ', {"name": "NVIDIA H100", "driver": "NVIDIA", "version": "550.54.14"}]'


def disk(folder: Path, fail_below_gb: float) -> Finding:
    return storage.check_disk(folder, warn_below_gb=1e9, fail_below_gb=fail_below_gb)


def write_parquet_like(folder: Path, end: bytes = b"PAR1") -> None:
    for name in storage.SHIPPED_TABLES:
        (folder / name).write_bytes(b"PAR1 rows " + end)


def broken_database(folder: Path) -> Path:
    (folder / "mlflow.db").write_text("no database")
    return folder / "mlflow.db"


def lock(folder: Path, text: str) -> Path:
    (folder / "requirements.lock").write_text(f"# comment\npytest=={pytest.__version__}\n{text}\n")
    return folder / "requirements.lock"


@pytest.mark.parametrize(
    ("check", "status", "fix"),
    [
        (lambda _: environment.check_python((3, 10)), Status.FAIL, "make setup"),
        (
            lambda tmp: environment.check_packages(lock(tmp, "no-such-package==1.0")),
            Status.FAIL,
            "make setup",
        ),
        (lambda tmp: environment.check_packages(lock(tmp, "numpy==0.1")), Status.WARN, "requirements.lock"),
        (lambda tmp: environment.check_packages(lock(tmp, "")), Status.OK, ""),
        (
            lambda _: graphics.judge_vulkan(ProbeResult(False, "libvulkan.so.1: no such file")),
            Status.FAIL,
            "system",
        ),
        (lambda _: graphics.judge_vulkan(ProbeResult(True, "[]")), Status.FAIL, "system_packages"),
        (lambda _: graphics.judge_vulkan(ProbeResult(True, OLD_MESA)), Status.FAIL, "system_packages"),
        (lambda _: graphics.judge_vulkan(ProbeResult(True, OLD_MESA_AND_CARD)), Status.OK, ""),
        (lambda _: graphics.judge_open3d(ProbeResult(False, "libGL.so.1: missing")), Status.FAIL, "libgl1"),
        (
            lambda _: graphics.judge_open3d(ProbeResult(False, "No module named 'open3d'")),
            Status.FAIL,
            "make setup",
        ),
        (lambda tmp: storage.check_shipped_table(tmp), Status.FAIL, "git restore"),
        (lambda tmp: disk(tmp, 1e8), Status.FAIL, "make clean"),
        (lambda tmp: disk(tmp, 0.0), Status.WARN, "make clean"),
        (lambda tmp: storage.check_mlflow_store(broken_database(tmp), None), Status.FAIL, "mv "),
        (lambda tmp: storage.check_mlflow_store(tmp / "mlflow.db", "./mlruns"), Status.FAIL, "sqlite:///"),
        (
            lambda tmp: storage.check_mlflow_store(tmp / "mlflow.db", "file:///mlruns"),
            Status.FAIL,
            "sqlite:///",
        ),
        (lambda tmp: storage.check_mlflow_store(tmp / "mlflow.db", "http://localhost:5000"), Status.OK, ""),
        (lambda tmp: storage.check_mlflow_store(tmp / "mlflow.db", None), Status.OK, ""),
    ],
)
def test_each_check_names_its_fix(check, status: Status, fix: str, tmp_path: Path) -> None:
    finding = check(tmp_path)
    assert finding.status is status, finding
    assert fix in finding.fix
    assert bool(finding.fix) == (status is not Status.OK)


def test_truncated_table_is_not_whole(tmp_path: Path) -> None:
    write_parquet_like(tmp_path)
    assert storage.check_shipped_table(tmp_path).status is Status.OK
    write_parquet_like(tmp_path, end=b"")
    assert "not a whole Parquet file" in storage.check_shipped_table(tmp_path).detail


def test_runs_in_the_store_are_counted(tmp_path: Path) -> None:
    connection = sqlite3.connect(tmp_path / "mlflow.db")
    connection.executescript("CREATE TABLE runs (run_uuid TEXT); INSERT INTO runs VALUES ('a'), ('b')")
    connection.close()
    assert "with 2 runs" in storage.check_mlflow_store(tmp_path / "mlflow.db", None).detail


def test_probe_tells_of_crash_and_hang() -> None:
    assert probe("-c", "raise OSError('libGL.so.1')") == ProbeResult(False, "OSError: libGL.so.1")
    assert probe("-c", "import os; os.abort()").text == "ended with status -6"
    assert "no answer" in probe("-c", "import time; time.sleep(9)", timeout_s=0.5).text


def test_one_failure_fails_the_whole(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    fine = Finding("Disk", Status.OK, "room")
    slow = Finding("PyTorch", Status.WARN, "CPU", "buy a card")
    broken = Finding("Vulkan device", Status.FAIL, "none", "install a driver")
    assert run_checks([lambda: fine, lambda: slow])
    assert not run_checks([lambda: fine, lambda: broken])
    assert "fix: install a driver" in caplog.text
    assert caplog.messages[-1] == "2 checks: 1 fine, 0 warnings, 1 failed"


def test_doctor_sees_a_vulkan_that_is_gone(tmp_path: Path) -> None:
    no_driver = {"VK_ICD_FILENAMES": str(tmp_path / "no.json"), "VK_DRIVER_FILES": str(tmp_path / "no.json")}
    command = [sys.executable, str(ROOT / "src" / "doctor.py")]
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | no_driver, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stdout
    assert "FAIL  Vulkan device" in done.stdout
    assert "fix: scripts/system_packages.sh" in done.stdout
    for name in ("Python", "PyTorch", "Open3D", "Robot data", "Shipped trial table"):
        assert f"OK    {name}" in done.stdout
