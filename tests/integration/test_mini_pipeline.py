"""`dvc repro` on the miniature of the pipeline, from collection to report, in a copy of the project."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from preshape.paths import project_root

PIPELINE = "pipelines/mini/dvc.yaml"
STAGES = ("collect", "render", "train", "evaluate", "report")
FOLDS = ("cross_validate@palm_points-seen", "cross_validate@config_cnn-seen")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project, as it is now, without anything that commands made."""
    copy = tmp_path_factory.mktemp("copy")
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=project_root(), capture_output=True, text=True, check=True).stdout
    for name in filter(None, names.split("\0")):
        if (project_root() / name).is_file() and name != "pipelines/mini/dvc.lock":
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(project_root() / name, copy / name)
    (copy / ".venv").unlink(missing_ok=True)
    (copy / ".venv").symlink_to(sys.prefix)
    subprocess.run(["git", "init", "--quiet"], cwd=copy, check=True)
    return copy


def start(copy: Path, *arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "dvc", "repro", PIPELINE, *arguments],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": f"{copy / 'src'}:{copy}", "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def repro(copy: Path, *arguments: str) -> set[str]:
    """Run to the end; the stages that were run."""
    process = start(copy, *arguments)
    output, _ = process.communicate()
    assert process.returncode == 0, output
    return stages_run(output)


def stages_run(output: str) -> set[str]:
    begun = (line for line in output.splitlines() if line.startswith("Running stage"))
    return {line.split("'")[1].removeprefix(f"{PIPELINE}:") for line in begun}


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_the_miniature_runs_goes_on_and_knows_what_changed(copy: Path) -> None:
    process = start(copy)
    assert process.stdout is not None
    for line in process.stdout:
        if "Rendering" in line or ":render'" in line:
            os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C does
            break
    process.communicate()
    assert process.returncode != 0
    assert repro(copy) == {*STAGES[1:], *FOLDS}  # the trials are there

    metrics = json.loads((copy / "outputs/train/mini_palm_points/metrics.json").read_text())
    assert metrics["n"] > 0
    assert "inference" in (copy / "outputs/mini/report.html").read_text(encoding="utf-8")
    assert (copy / "outputs/mini/curves/roc.csv").is_file()
    assert (copy / "outputs/mini/first_pass.json").is_file()

    assert repro(copy) == set()
    settings = copy / "conf/model/config_cnn.yaml"
    settings.write_text(settings.read_text(encoding="utf-8") + "# touched\n", encoding="utf-8")
    assert repro(copy, "--dry") == {"cross_validate@config_cnn-seen"}
    settings = copy / "conf/planner/inference.yaml"
    settings.write_text(settings.read_text(encoding="utf-8") + "# touched\n", encoding="utf-8")
    assert repro(copy, "--dry") == {"cross_validate@config_cnn-seen", "evaluate"}
