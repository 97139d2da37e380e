"""`python src/train.py` as a user runs it, on a tiny synthetic data set."""

import json
import pickle
import subprocess
from collections.abc import Callable
from pathlib import Path

import cloudpickle
import mlflow
import pandas as pd
import pytest
from mlflow import MlflowClient
from ready_python import ReadyPython
from synthetic_scenes import BoxRenderer, make_scene, write_data_set

from preshape.configured_planner import plan_view
from preshape.errors import InputError
from preshape.paths import project_root
from preshape.perception.view_files import save_view
from preshape.provenance import processor_name

FIXTURES = project_root() / "tests" / "fixtures"


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("place")
    write_data_set(place / "data" / "allegro_grocery", 15)
    return place


Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def run_train(place: Path, ready_python: ReadyPython) -> Run:
    """Train with little of everything."""

    def run(*overrides: str) -> "subprocess.CompletedProcess[str]":
        settings = (
            *(override for override in overrides if override.startswith("--")),
            *(f"paths.{name}={place / name}" for name in ("data", "cache", "outputs")),
            f"tracking.database={place / 'mlflow.db'}",
            f"tracking.artifacts={place / 'mlartifacts'}",
            "dataset.data.views.renderer={_target_:synthetic_scenes.BoxRenderer}",
            "dataset.data.views.maker=null",
            "dataset.data.hold_out.validation_fraction=0.25",
            "learning.settings.iterations=6",
            "learning.batch_size=8",
            "trainer.batches_per_epoch=3",
            *(override for override in overrides if not override.startswith("--")),
        )
        return ready_python.run(project_root() / "src" / "train.py", *settings, cwd=place, modules=FIXTURES)

    return run


@pytest.fixture(scope="module")
def trained(run_train: Run) -> "subprocess.CompletedProcess[str]":
    """A finished training of the default network in `place`."""
    done = run_train()
    assert done.returncode == 0, done.stderr
    return done


def test_a_training_from_tables_to_tracked_weights(
    place: Path, trained: "subprocess.CompletedProcess[str]"
) -> None:
    folder = place / "outputs" / "train" / "palm_points"
    metrics = json.loads((folder / "metrics.json").read_text())
    assert metrics["command"].startswith("python src/train.py")
    last_line = trained.stdout.splitlines()[-1]
    assert f"on {metrics['n']} held-out trials" in last_line
    assert str(folder / "model.safetensors") in last_line
    sidecar = json.loads((folder / "model.safetensors.json").read_text())
    assert sidecar["metrics"]["auc"] == metrics["auc"]

    client = MlflowClient(f"sqlite:///{place / 'mlflow.db'}")
    experiment = client.get_experiment_by_name("preshape/allegro_grocery")
    assert experiment is not None
    (run,) = client.search_runs([experiment.experiment_id])
    assert run.info.status == "FINISHED"
    assert run.data.params["model.name"] == "palm_points"
    assert run.data.tags["data_hash"] == sidecar["data_hash"]
    assert run.data.tags["device"] == processor_name()
    assert run.data.tags["mlflow.source.name"] == metrics["command"]
    assert [point.step for point in client.get_metric_history(run.info.run_id, "train_loss")] == [3, 6]
    kept = {file.path for file in client.list_artifacts(run.info.run_id)}
    assert {"roc.png", "model.safetensors", "model.safetensors.json", "metrics.json"} <= kept


@pytest.mark.usefixtures("trained")
def test_the_registered_model_is_the_network(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (pickle, cloudpickle):
        for name in ("load", "loads"):
            monkeypatch.setattr(module, name, None)
    mlflow.set_tracking_uri(f"sqlite:///{place / 'mlflow.db'}")
    logged = mlflow.pyfunc.load_model("models:/palm_points/1")

    save_view(place / "view", BoxRenderer()(make_scene(0)))
    weights = place / "outputs" / "train" / "palm_points" / "model.safetensors"
    plan = plan_view(place / "view", weights, "planner=max_eval")
    grasps = pd.DataFrame(plan.result.initial_theta, columns=list(plan.space.names))
    probs = logged.predict(grasps, params={"view": str(place / "view")})["success_prob"]
    assert probs.to_numpy() == pytest.approx(plan.result.initial_success_prob, abs=1e-6)

    predictions = pd.read_parquet(weights.with_name("predictions.parquet"))
    (prob,) = logged.predict(logged.input_example, params={"view": "example"})["success_prob"]
    assert prob == pytest.approx(predictions["success_prob"][0], abs=1e-6)
    with pytest.raises(InputError, match="none is given"):
        logged.predict(grasps)


def test_a_sweep_from_an_empty_store_can_be_started_again(run_train: Run, place: Path) -> None:
    sweep = ("run_name=sweep", "tracking.database=${paths.outputs}/sweep.db", "split=unseen", "fold=0,1")
    begun = run_train("--multirun", "hydra/launcher=joblib", "hydra.launcher.n_jobs=2", *sweep)
    assert begun.returncode == 0, begun.stderr
    (table,) = (place / "outputs" / "train" / "sweeps").glob("*/runs.md")
    assert table.read_text() in begun.stdout
    (summary,) = (place / "outputs" / "train").glob("sweep,*/summary.json")
    assert json.loads(summary.read_text())["command"].startswith("python src/train.py --multirun ")
    (summary.parent / "unseen_fold1" / "metrics.json").unlink()
    again = run_train("--multirun", *sweep)
    assert again.returncode == 0, again.stderr
    assert again.stdout.count("had been trained before") == 1

    client = MlflowClient(f"sqlite:///{place / 'outputs' / 'sweep.db'}")
    experiment = client.get_experiment_by_name("preshape/allegro_grocery")
    assert experiment is not None
    (parent,) = client.search_runs([experiment.experiment_id], "tags.sweep != ''")
    children = client.search_runs(
        [experiment.experiment_id], f"tags.`mlflow.parentRunId` = '{parent.info.run_id}'"
    )
    assert sorted(run.info.run_name for run in children) == ["unseen_fold0", "unseen_fold1"]
    assert {run.info.status for run in (parent, *children)} == {"FINISHED"}
    areas = [run.data.metrics["test_auc"] for run in children]
    assert parent.data.metrics["unseen_auc_mean"] == pytest.approx(sum(areas) / 2)
    kept = {file.path for file in client.list_artifacts(parent.info.run_id)}
    assert kept == {"roc_unseen.png", "summary.json", "runs.csv"}
    assert parent.data.tags["mlflow.note.content"] == table.read_text()


def test_a_missing_table_is_refused(run_train: Run, place: Path) -> None:
    done = run_train("run_name=refused", "paths.data=nowhere")
    assert done.returncode == 2, done.stderr
    assert "no table of scenes" in done.stderr
    assert "Traceback" not in done.stderr
    left = {path.name for path in (place / "outputs" / "train" / "refused").iterdir()}
    assert left <= {".hydra", "train.log"}
