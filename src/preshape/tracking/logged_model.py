"""Trained success networks as MLflow's `pyfunc` models: weights, settings and an example, nothing pickled.

What runs when such a model is loaded is `success_predictor`. The folder holds a copy of the three lines that
name it (MLflow's "models from code"), safetensors, and JSON.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import pandas as pd
from jaxtyping import Float
from safetensors.torch import save_file
from torch import Tensor

from preshape.models.checkpoints import sidecar_path
from preshape.perception.view_batch import ViewBatch
from preshape.provenance import package_versions

if TYPE_CHECKING:
    from mlflow import MlflowClient

CODE = Path(__file__).with_name("success_predictor_model.py")
EXAMPLE_VIEW = "example"
"""What the parameter `view` of a logged model is called for the view that comes with it."""
EXAMPLE_FILE = "example_view.safetensors"
OUTPUT = "success_prob"
REQUIRED = ("mlflow", "numpy", "torch")
"""Packages whose versions are recorded; the model runs where this checkout is installed."""


@dataclass(frozen=True, eq=False)
class TrainedModel:
    """A trained success network, as files and facts.

    Args:
        name: name under which it is kept.
        weights: its file, the sidecar beside it.
        settings: the configuration of the network, as in `conf/model`, resolved.
        theta_names: names of the parameters of theta, in order.
        view: the view of a held-out trial; only what the network looks at.
        theta: grasps in that view (camera frame, m and rad).
    """

    name: str
    weights: Path
    settings: Mapping[str, Any]
    theta_names: tuple[str, ...]
    view: Mapping[str, Tensor]
    theta: Float[Tensor, "n d"]

    @property
    def example(self) -> tuple[pd.DataFrame, dict[str, str]]:
        """Input and parameters with which the logged model can be tried out."""
        grasps = pd.DataFrame(self.theta.double().numpy(), columns=list(self.theta_names))
        return grasps, {"view": EXAMPLE_VIEW}


def seen_parts(view: ViewBatch, looks_at: tuple[str, ...]) -> dict[str, Tensor]:
    """What a network looks at of the first view of a batch."""
    return {name: getattr(view, name)[:1].contiguous() for name in looks_at}


def write_model_folder(folder: Path, model: TrainedModel) -> None:
    """Write a folder that `mlflow.pyfunc.load_model` takes.

    Its input is a table with a column for each parameter of theta, its parameter `view` the folder of a saved
    view (`preshape.perception.view_files`), and its output the column `success_prob`.

    Args:
        folder: where; must not be there yet.
        model: what to write.
    """
    from mlflow import pyfunc
    from mlflow.models import ModelSignature
    from mlflow.types import ColSpec, ParamSchema, ParamSpec, Schema

    signature = ModelSignature(
        Schema([ColSpec("double", name) for name in model.theta_names]),
        Schema([ColSpec("double", OUTPUT)]),
        ParamSchema([ParamSpec("view", "string", "")]),
    )
    example = folder.with_name(EXAMPLE_FILE)
    save_file(dict(model.view), example)
    files = {"weights": model.weights, "sidecar": sidecar_path(model.weights), "example": example}
    versions = package_versions()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pyfunc.save_model(
            folder,
            python_model=str(CODE),
            artifacts={name: str(file) for name, file in files.items()},
            model_config=dict(model.settings),
            signature=signature,
            input_example=model.example,
            pip_requirements=[f"{name}=={versions[name]}" for name in REQUIRED],
        )


def log_model(client: "MlflowClient", run_id: str, model: TrainedModel) -> str:
    """Keep a model with the run that trained it.

    Returns:
        MLflow's number of it: `models:/<number>` is its address.
    """
    from mlflow.entities import LoggedModelOutput

    experiment_id = client.get_run(run_id).info.experiment_id
    with TemporaryDirectory() as folder:
        write_model_folder(Path(folder) / "model", model)
        logged = client.create_logged_model(experiment_id, name=model.name, source_run_id=run_id)
        client.log_model_artifacts(logged.model_id, str(Path(folder) / "model"))
    client.finalize_logged_model(logged.model_id, "READY")
    client.log_outputs(run_id, [LoggedModelOutput(logged.model_id, step=0)])
    return str(logged.model_id)


def register_model(client: "MlflowClient", run_id: str, model_id: str, name: str) -> None:
    """Make a kept model the newest version of a registered one: `models:/<name>/latest`."""
    from mlflow.exceptions import MlflowException
    from mlflow.protos.databricks_pb2 import RESOURCE_ALREADY_EXISTS, ErrorCode

    try:
        client.create_registered_model(name)
    except MlflowException as error:
        if error.error_code != ErrorCode.Name(RESOURCE_ALREADY_EXISTS):
            raise
    source = client.get_logged_model(model_id).artifact_location  # models:/... is looked up in another store
    client.create_model_version(name, source, run_id, model_id=model_id)
