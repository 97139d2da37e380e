"""Tracked runs, in a real MLflow store."""

import multiprocessing
from pathlib import Path

import pytest
from mlflow import MlflowClient
from parallel_runs import log_fold

from preshape.errors import InputError
from preshape.tracking.mlflow_store import MlflowTracking, flatten
from preshape.tracking.tracked_run import NoTracking, SweepMember


def store(folder: Path) -> MlflowTracking:
    return MlflowTracking(folder / "mlflow.db", folder / "mlartifacts", "preshape")


def test_a_run_keeps_configuration_curves_and_files(tmp_path: Path) -> None:
    picture = tmp_path / "roc.png"
    picture.write_bytes(b"picture")
    config = {"model": {"name": "config_cnn"}, "many": {f"key_{i}": i for i in range(150)}}
    with store(tmp_path).run("config_cnn", config, {"git_revision": "abc"}) as run:
        run.log({"loss": 0.7, "auc": float("nan")}, step=10)
        run.log({"loss": 0.5, "auc": 0.8}, step=20)
        run.keep(picture)
    with pytest.raises(ValueError, match="broken"), store(tmp_path).run("second", {}, {}):
        raise ValueError("broken")

    client = MlflowClient(f"sqlite:///{tmp_path / 'mlflow.db'}")
    experiment = client.get_experiment_by_name("preshape")
    assert experiment is not None
    failed, finished = client.search_runs([experiment.experiment_id], order_by=["start_time DESC"])
    assert (failed.info.status, finished.info.status) == ("FAILED", "FINISHED")
    assert finished.data.params == flatten(config)
    assert finished.data.tags["git_revision"] == "abc"
    losses = client.get_metric_history(finished.info.run_id, "loss")
    assert [(point.step, point.value) for point in losses] == [(10, 0.7), (20, 0.5)]
    assert [point.step for point in client.get_metric_history(finished.info.run_id, "auc")] == [20]
    assert [file.path for file in client.list_artifacts(finished.info.run_id)] == ["roc.png"]


def test_a_sweep_is_one_run_with_a_child_of_each_name(tmp_path: Path) -> None:
    def fold(name: str, digest: str, trained: bool = False, broken: bool = False) -> None:
        member = SweepMember("sweep", "settings", digest, trained)
        with store(tmp_path).run(name, {"fold": name}, {}, member) as run:
            run.log({"auc": 0.8}, step=1)
            assert run.parent is not None
            run.parent.log({"auc_mean": 0.7}, step=1)
            if broken:
                raise ValueError("broken")

    def states() -> dict[str, str]:
        client = MlflowClient(f"sqlite:///{tmp_path / 'mlflow.db'}")
        runs = client.search_runs(["1"])
        (parent,) = (run for run in runs if run.info.run_name == "sweep")
        assert parent.data.metrics["auc_mean"] == 0.7
        children = [run for run in runs if run is not parent]
        assert {run.data.tags["mlflow.parentRunId"] for run in children} == {parent.info.run_id}
        assert len({run.info.run_name for run in children}) == len(children)
        return {run.info.run_name: run.info.status for run in runs}

    fold("fold0", "a")
    with pytest.raises(ValueError, match="broken"):
        fold("fold1", "a", broken=True)
    assert states() == {"sweep": "FAILED", "fold0": "FINISHED", "fold1": "FAILED"}
    fold("fold1", "a")  # goes on
    fold("fold0", "a", trained=True)  # stays
    fold("fold0", "b")  # other code: replaced
    assert states() == {"sweep": "FINISHED", "fold0": "FINISHED", "fold1": "FINISHED"}


def test_twenty_runs_in_parallel_lose_none(tmp_path: Path) -> None:
    groups, folds = [f"group{number}" for number in range(4)], range(5)
    jobs = [(tmp_path, group, fold) for fold in folds for group in groups]
    with multiprocessing.get_context("fork").Pool(10) as pool:  # copies of this process: MLflow is imported
        pool.starmap(log_fold, jobs, chunksize=1)

    client = MlflowClient(f"sqlite:///{tmp_path / 'mlflow.db'}")
    experiment = client.get_experiment_by_name("preshape/boxes")
    assert experiment is not None
    runs = client.search_runs([experiment.experiment_id])
    assert {run.info.status for run in runs} == {"FINISHED"}
    parents = {run.info.run_id: run.info.run_name for run in runs if "sweep" in run.data.tags}
    assert sorted(parents.values()) == groups
    children = [run for run in runs if run.info.run_id not in parents]
    named = {(parents[run.data.tags["mlflow.parentRunId"]], run.info.run_name) for run in children}
    assert named == {(group, f"fold{fold}") for group in groups for fold in folds}
    for run in children:
        steps = [point.step for point in client.get_metric_history(run.info.run_id, "loss")]
        assert steps == list(range(10))
        assert len(client.list_artifacts(run.info.run_id)) == 1
    for run_id in parents:
        assert len(client.get_metric_history(run_id, "auc_mean")) == len(folds)


def test_a_store_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mlflow.db").write_text("not a database, but long enough to look like a file " * 40)
    with pytest.raises(InputError, match="MLflow store"), store(tmp_path).run("name", {}, {}):
        pass


def test_tracking_can_be_left_out(tmp_path: Path) -> None:
    with NoTracking().run("name", {}, {}) as run:
        run.log({"loss": 0.5}, step=1)
        run.keep(tmp_path / "nothing")


def test_configurations_become_flat() -> None:
    assert flatten({"a": {"b": {"c": 1}, "d": [1, 2]}, "e": {}}) == {"a.b.c": "1", "a.d": "[1, 2]", "e": "{}"}
