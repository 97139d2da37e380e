"""Training and detection on rectangles as a user runs them, on a tiny synthetic copy of the Cornell data."""

import json
import subprocess
from pathlib import Path

from ready_python import ReadyPython
from synthetic_cornell import write_cornell

from preshape.paths import project_root


def run(python: ReadyPython, script: str, place: Path, *overrides: str) -> "subprocess.CompletedProcess[str]":
    settings = (
        *(override for override in overrides if override.startswith("--")),
        *(f"paths.{name}={place / name}" for name in ("cache", "outputs")),
        *("dataset=cornell", f"dataset.root={place / 'cornell'}", "model=patches_cnn", "tracking=none"),
        *(override for override in overrides if not override.startswith("--")),
    )
    return python.run(project_root() / "src" / script, *settings, cwd=place)


def test_folds_are_trained_and_detected_in(ready_python: ReadyPython, tmp_path: Path) -> None:
    write_cornell(tmp_path / "cornell", n=5, cloud=False)
    small = ("learning.settings.iterations=3", "learning.settings.schedule=steps", "learning.batch_size=4")
    trained = run(
        *(ready_python, "train.py", tmp_path, "--multirun", "split=unseen", "fold=0,1,2,3,4"),
        *("run_name=tiny", "trainer.batches_per_epoch=3", *small),
    )
    assert trained.returncode == 0, trained.stderr
    (group,) = (tmp_path / "outputs" / "train").glob("tiny*")
    metrics = json.loads((group / "unseen_fold0" / "metrics.json").read_text())
    assert (metrics["n"], metrics["threshold"]) == (2, 0.5)

    result = tmp_path / "cornell.json"
    detected = run(
        *(ready_python, "detect.py", tmp_path, f"runs='{group}'", "splits=[unseen]", f"output={result}"),
        *("detector.counts=[1,2]", "detector.planner.starts.count=2", "detector.grid.step_px=60"),
        "detector.grid.angles=2",
    )
    assert detected.returncode == 0, detected.stderr
    assert "object-wise recognition accuracy" in detected.stdout.splitlines()[-1]
    rows = {row["metric"]: row for row in json.loads(result.read_text())["runs"]}
    assert rows["recognition_accuracy"]["n"] == 10
    assert rows["detection_inference_2"]["n"] == rows["detection_grid"]["n"] == 5
    assert (group / "unseen_fold0" / "detections.json").is_file()
