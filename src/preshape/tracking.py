"""Keeping runs where they can be compared: MLflow, or nowhere."""

import logging
import math
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from preshape.errors import InputError

if TYPE_CHECKING:
    from mlflow import MlflowClient

ENTRIES_PER_REQUEST = 100
LONGEST_VALUE = 500


@runtime_checkable
class TrackedRun(Protocol):
    """One run, while it goes on."""

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Add a point to each of these curves."""

    def keep(self, file: Path) -> None:
        """Keep a copy of a file with the run."""


@runtime_checkable
class Tracking(Protocol):
    """Where runs are kept."""

    def run(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str]
    ) -> AbstractContextManager[TrackedRun]:
        """Begin a run with its resolved configuration; leaving the context ends it."""


class UntrackedRun:
    """A run that nobody keeps."""

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Forget them."""

    def keep(self, file: Path) -> None:
        """Leave the file where it is."""


class NoTracking:
    """Keeps nothing (`tracking=none`)."""

    @contextmanager
    def run(self, name: str, config: Mapping[str, Any], tags: Mapping[str, str]) -> Iterator[TrackedRun]:
        """A run that nobody keeps."""
        yield UntrackedRun()


class MlflowRun:
    """A run in an MLflow store.

    Args:
        client: connection to the store.
        run_id: MLflow's name of the run.
    """

    def __init__(self, client: "MlflowClient", run_id: str) -> None:
        self._client, self._run_id = client, run_id

    def log(self, values: Mapping[str, float], step: int) -> None:
        """Add a point to each of these curves; values that are not finite are left out."""
        from mlflow.entities import Metric

        now = int(time.time() * 1000)
        metrics = [Metric(key, value, now, step) for key, value in values.items() if math.isfinite(value)]
        self._client.log_batch(self._run_id, metrics=metrics)

    def keep(self, file: Path) -> None:
        """Keep a copy of a file with the run."""
        self._client.log_artifact(self._run_id, str(file))


class MlflowTracking:
    """Keeps runs in an MLflow store on this machine.

    Args:
        database: SQLite file with parameters and curves.
        artifacts: folder for files.
        experiment: the experiment to which runs are added.
    """

    def __init__(self, database: str | Path, artifacts: str | Path, experiment: str) -> None:
        self._database, self._artifacts = Path(database).absolute(), Path(artifacts).absolute()
        self._experiment = experiment

    @contextmanager
    def run(self, name: str, config: Mapping[str, Any], tags: Mapping[str, str]) -> Iterator[TrackedRun]:
        """A run that ends as finished, failed or killed, as its context does.

        Raises:
            InputError: if the store cannot be used.
        """
        client, run_id = self._begin(name, config, tags)
        status = "FAILED"
        try:
            yield MlflowRun(client, run_id)
            status = "FINISHED"
        except KeyboardInterrupt:
            status = "KILLED"
            raise
        finally:
            client.set_terminated(run_id, status)

    def _begin(
        self, name: str, config: Mapping[str, Any], tags: Mapping[str, str]
    ) -> tuple["MlflowClient", str]:
        # Takes seconds to import, and would otherwise report its use to its makers.
        os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
        from mlflow import MlflowClient
        from mlflow.entities import Param
        from mlflow.exceptions import MlflowException
        from sqlalchemy.exc import SQLAlchemyError

        for noisy in ("alembic", "mlflow"):
            logging.getLogger(noisy).setLevel(logging.WARNING)
        try:
            self._database.parent.mkdir(parents=True, exist_ok=True)
            client = MlflowClient(f"sqlite:///{self._database}")
            run_id = client.create_run(
                self._experiment_id(client), tags=dict(tags), run_name=name
            ).info.run_id
            params = [Param(key, value) for key, value in flatten(config).items()]
            for first in range(0, len(params), ENTRIES_PER_REQUEST):
                client.log_batch(run_id, params=params[first : first + ENTRIES_PER_REQUEST])
        except (MlflowException, SQLAlchemyError, OSError) as error:
            raise InputError(
                f"The MLflow store cannot be used: {str(error).splitlines()[0]}",
                where=self._database,
                fix="move the file away, choose another with tracking.database=FILE, or take tracking=none",
            ) from error
        return client, run_id

    def _experiment_id(self, client: "MlflowClient") -> str:
        experiment = client.get_experiment_by_name(self._experiment)
        if experiment is not None:
            return str(experiment.experiment_id)
        return str(client.create_experiment(self._experiment, artifact_location=self._artifacts.as_uri()))


def flatten(config: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """A nested configuration as `group.key: value`, with long values shortened."""
    flat: dict[str, str] = {}
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)[:LONGEST_VALUE]
    return flat
