"""Runs in an MLflow store on this machine, those of a sweep as children of one run."""

import logging
import math
import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from preshape.errors import InputError
from preshape.files import exclusive
from preshape.provenance import lasting_command
from preshape.tracking.logged_model import TrainedModel, log_model, register_model
from preshape.tracking.tracked_run import MULTIRUN_TAG, SweepMember, TrackedRun

if TYPE_CHECKING:
    from mlflow import MlflowClient
    from mlflow.entities import Run

ENTRIES_PER_REQUEST = 100
LONGEST_VALUE = 500
PATIENCE_S = 60
"""How long a process waits while another one writes to the database."""
SWEEP_TAG, MEMBER_TAG = "sweep", "identity"
PARENT_TAG = "mlflow.parentRunId"
"""By this tag MLflow's pages show a run below another."""
DESCRIPTION_TAG = "mlflow.note.content"


class MlflowRun:
    """A run in an MLflow store.

    Args:
        client: connection to the store.
        run_id: MLflow's name of the run.
        parent: the run of its sweep.
        was_finished: whether it had already come to its end.
    """

    def __init__(
        self,
        client: "MlflowClient",
        run_id: str,
        parent: TrackedRun | None = None,
        was_finished: bool = False,
    ) -> None:
        self._client, self._run_id = client, run_id
        self.parent, self.was_finished = parent, was_finished

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Add a point to each of these curves; values that are not finite are left out."""
        from mlflow.entities import Metric

        now = int(time.time() * 1000)
        metrics = [Metric(key, value, now, step) for key, value in values.items() if math.isfinite(value)]
        _in_parts(metrics, lambda part: self._client.log_batch(self._run_id, metrics=part))

    def keep(self, file: Path) -> None:
        """Keep a copy of a file with the run."""
        self._client.log_artifact(self._run_id, str(file))

    def keep_table(self, rows: Path, table: Path) -> None:
        """Keep the table of a command with the runs of its sweeps, and show it as their description."""
        own = self._client.get_run(self._run_id)
        name = own.data.tags[MULTIRUN_TAG]
        wanted = f"tags.{MULTIRUN_TAG} = '{name}' and tags.{SWEEP_TAG} != ''"
        for run in self._client.search_runs([own.info.experiment_id], wanted):
            self._client.log_artifact(run.info.run_id, str(rows))
            self._client.set_tag(run.info.run_id, DESCRIPTION_TAG, table.read_text(encoding="utf-8"))

    def keep_model(self, model: TrainedModel) -> None:
        """Keep a network for `mlflow.pyfunc.load_model`, and register it unless it is one of a sweep."""
        model_id = log_model(self._client, self._run_id, model)
        if self.parent is None:
            register_model(self._client, self._run_id, model_id, model.name)


class MlflowTracking:
    """Keeps runs in an MLflow store on this machine, which several processes may share.

    Args:
        database: SQLite file with parameters and curves.
        artifacts: folder for files.
        experiment: the experiment to which runs are added.
    """

    def __init__(self, database: str | Path, artifacts: str | Path, experiment: str) -> None:
        self._database, self._artifacts = Path(database).absolute(), Path(artifacts).absolute()
        self._experiment = experiment

    @contextmanager
    def run(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str], sweep: SweepMember | None = None
    ) -> Iterator[TrackedRun]:
        """A run that ends as finished, failed or killed, as its context does.

        In a sweep it is a child of the sweep's run, which ends when none of its children goes on. The child
        of the same name goes on if there is one, or is replaced if it has other figures.

        Raises:
            InputError: if the store cannot be used.
        """
        client, run, parent_id = self._begin(name, config, tags, sweep)
        was_finished = run.info.status == "FINISHED"
        status = "FAILED"
        try:
            parent = None if parent_id is None else MlflowRun(client, parent_id)
            yield MlflowRun(client, run.info.run_id, parent, was_finished)
            status = "FINISHED"
        except KeyboardInterrupt:
            status = "KILLED"
            raise
        finally:
            if not was_finished:
                client.set_terminated(run.info.run_id, status)
            if parent_id is not None:
                self._end_with_children(client, parent_id)

    def _begin(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str], sweep: SweepMember | None
    ) -> tuple["MlflowClient", "Run", str | None]:
        """Connection, the run, and the number of the sweep's run."""
        # Takes seconds to import, and would otherwise report its use to its makers.
        os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
        os.environ.setdefault("MLFLOW_ENABLE_ARTIFACTS_PROGRESS_BAR", "false")
        from mlflow import MlflowClient
        from mlflow.exceptions import MlflowException
        from sqlalchemy.exc import SQLAlchemyError

        for noisy in ("alembic", "mlflow"):
            logging.getLogger(noisy).setLevel(logging.WARNING)
        try:
            with self._alone():
                client = MlflowClient(f"sqlite:///{self._database}?timeout={PATIENCE_S}")
                experiment_id = self._experiment_id(client)
                tags = {**tags, **_source(tags)}
                if sweep is None:
                    parent_id, run = None, client.create_run(experiment_id, tags=dict(tags), run_name=name)
                else:
                    parent_id = _sweep_run(client, experiment_id, sweep, tags)
                    run = _child(client, experiment_id, name, tags, sweep, parent_id)
            known = run.data.params
            _log_params(client, run, {k: v for k, v in flatten(config).items() if k not in known})
        except (MlflowException, SQLAlchemyError, OSError) as error:
            raise InputError(
                f"The MLflow store cannot be used: {str(error).splitlines()[0]}",
                where=self._database,
                fix="move the file away, choose another with tracking.database=FILE, or take tracking=none",
            ) from error
        return client, run, parent_id

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """While no other process makes tables or runs in this database."""
        with exclusive(self._database.with_name(f"{self._database.name}.lock")):
            yield

    def _experiment_id(self, client: "MlflowClient") -> str:
        experiment = client.get_experiment_by_name(self._experiment)
        if experiment is not None:
            return str(experiment.experiment_id)
        return str(client.create_experiment(self._experiment, artifact_location=self._artifacts.as_uri()))

    def _end_with_children(self, client: "MlflowClient", parent_id: str) -> None:
        """End the run of a sweep with the worst status of its children, unless one still goes on."""
        with self._alone():
            experiment_id = client.get_run(parent_id).info.experiment_id
            children = client.search_runs([experiment_id], f"tags.`{PARENT_TAG}` = '{parent_id}'")
            states = {child.info.status for child in children}
            if "RUNNING" not in states:
                worst = next((state for state in ("FAILED", "KILLED") if state in states), "FINISHED")
                client.set_terminated(parent_id, worst)


def _source(tags: Mapping[str, str]) -> dict[str, str]:
    """What MLflow's pages show as the source and the version of a run."""
    revision = tags.get("git_revision", "unknown").removesuffix("-dirty")
    return {"mlflow.source.name": lasting_command(), "mlflow.source.git.commit": revision}


def _sweep_run(
    client: "MlflowClient", experiment_id: str, sweep: SweepMember, tags: Mapping[str, str]
) -> str:
    """Number of the run of a sweep, which goes on; made if there is none."""
    found = client.search_runs([experiment_id], f"tags.{SWEEP_TAG} = '{sweep.digest}'", max_results=1)
    if found:
        run_id = str(found[0].info.run_id)
        client.update_run(run_id, status="RUNNING")
        client.set_tag(run_id, MULTIRUN_TAG, tags.get(MULTIRUN_TAG, ""))
        return run_id
    tags = {**tags, SWEEP_TAG: sweep.digest}
    return str(client.create_run(experiment_id, tags=tags, run_name=sweep.name).info.run_id)


def _child(
    client: "MlflowClient",
    experiment_id: str,
    name: str,
    tags: Mapping[str, str],
    sweep: SweepMember,
    parent_id: str,
) -> "Run":
    """The child of that name, which goes on if it came to no end; a new one if there is none, or another."""
    wanted = f"tags.`{PARENT_TAG}` = '{parent_id}' and attributes.run_name = '{name}'"
    for run in client.search_runs([experiment_id], wanted):
        ended = run.info.status == "FINISHED"
        if sweep.trained or (not ended and run.data.tags.get(MEMBER_TAG) == sweep.member_digest):
            if not ended:
                client.update_run(run.info.run_id, status="RUNNING")
            return run
        client.delete_run(run.info.run_id)
    tags = {**tags, PARENT_TAG: parent_id, MEMBER_TAG: sweep.member_digest}
    return client.create_run(experiment_id, tags=tags, run_name=name)


def _log_params(client: "MlflowClient", run: "Run", values: Mapping[str, str]) -> None:
    from mlflow.entities import Param

    params = [Param(key, value) for key, value in values.items()]
    _in_parts(params, lambda part: client.log_batch(run.info.run_id, params=part))


def _in_parts(entries: list[Any], send: Callable[[list[Any]], object]) -> None:
    """Send entries in requests of a size that MLflow takes."""
    for first in range(0, len(entries), ENTRIES_PER_REQUEST):
        send(entries[first : first + ENTRIES_PER_REQUEST])


def flatten(config: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """A nested configuration as `group.key: value`, with long values shortened."""
    flat: dict[str, str] = {}
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)[:LONGEST_VALUE]
    return flat
