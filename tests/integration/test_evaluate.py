"""`python sim/evaluate.py` and the page made of it, as a user runs them."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
import torch
from mlflow import MlflowClient
from ready_python import ReadyPython

from preshape.data.tables import read_data_set
from preshape.grasps.space import GraspSpace
from preshape.models.checkpoints import save_weights
from preshape.models.palm_points import PalmPoints
from preshape.paths import project_root

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def run(ready_python: ReadyPython, tmp_path: Path) -> Run:
    """Run a command in the folder of the test."""

    def run(script: str, *overrides: str) -> "subprocess.CompletedProcess[str]":
        places = (f"paths.{name}={tmp_path / name}" for name in ("cache", "outputs"))
        return ready_python.run(project_root() / script, *places, *overrides, cwd=tmp_path)

    return run


def test_planners_compete_on_one_scene_and_a_page_shows_it(
    run: Run, tmp_path: Path, allegro_space: GraspSpace
) -> None:
    torch.manual_seed(0)
    model = PalmPoints("palm_points", allegro_space.name, allegro_space.dim)
    weights = tmp_path / "model.safetensors"
    save_weights(weights, model, data_hash="none", git_revision="none", metrics={})
    settings = ("evaluate.workers=1", "evaluate.filmed_scenes=1", "evaluator.recorder.every=150")
    done = run("sim/evaluate.py", f"weights={weights}", *settings, "evaluate.scenes=1", "tracking=none")
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "outputs" / "evaluate" / "palm_points"
    summary = json.loads((folder / "evaluation.json").read_text())["planners"]
    assert set(summary) == {"heuristic", "max_eval", "inference"}
    scenes, trials = read_data_set(folder, allegro_space)
    assert len(scenes) == 1
    for name, planner in summary.items():
        own = trials.where((trials.rows["planner"] == name).to_numpy(dtype=bool))
        assert planner["executed"] == len(own.executed)
        assert planner["lifted"] == own.lifted.sum()
    assert summary["max_eval"]["executed"] <= 1
    assert summary["inference"]["executed"] <= 1
    assert len(list((folder / "plans").glob("*.json"))) == 3

    page = tmp_path / "page.html"
    shown = run(
        "analysis/report.py",
        "report=demo",
        *(f"report.evaluation={folder}", "report.metrics=null", f"report.output={page}"),
    )
    assert shown.returncode == 0, shown.stderr
    assert shown.stdout.splitlines()[-1].endswith(str(page))
    assert "http://" not in page.read_text().replace("http://www.w3.org", "")

    store = [f"tracking.{name}={tmp_path / name}" for name in ("database", "artifacts")]
    sweep = (f"weights={weights}", *settings, *store, "run_name=sweep", "evaluate.scenes=1,2", "--multirun")
    more = run("sim/evaluate.py", *sweep)
    assert more.returncode == 0, more.stderr
    assert "1 of 2 scenes are there" in more.stdout
    (table,) = (tmp_path / "outputs" / "evaluate" / "sweeps").glob("*/runs.csv")
    rows = pd.read_csv(table)
    assert set(rows["run"]) == {"scenes=1", "scenes=2"}
    assert len(rows) == 2 * len(summary)
    assert table.with_suffix(".md").read_text() in more.stdout
    longer = read_data_set(
        table.parents[2] / rows.set_index("run")["folder"]["scenes=2"].iloc[0], allegro_space
    )
    assert longer[1].rows[: len(trials)].equals(trials.rows)
    assert len(longer[0]) == 2

    client = MlflowClient(f"sqlite:///{tmp_path / 'database'}")
    experiment = client.get_experiment_by_name("preshape/evaluations")
    assert experiment is not None
    runs = client.search_runs([experiment.experiment_id])
    (parent,) = (found for found in runs if "sweep" in found.data.tags)
    assert parent.data.tags["mlflow.note.content"] == table.with_suffix(".md").read_text()
    assert len(runs) == 3
    assert {found.info.status for found in runs} == {"FINISHED"}


def test_weights_that_are_not_there_are_refused_before_any_work(run: Run, tmp_path: Path) -> None:
    done = run("sim/evaluate.py", f"weights={tmp_path / 'missing.safetensors'}")
    assert done.returncode == 2
    assert "missing.safetensors" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "cache" / "evaluate").exists()
