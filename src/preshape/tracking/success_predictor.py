"""A logged network as a function from grasps and a view to success probabilities, for `mlflow.pyfunc`."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import torch
from hydra.utils import instantiate
from mlflow.pyfunc.model import PythonModel, PythonModelContext
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor

from preshape.errors import InputError
from preshape.models.checkpoints import load_weights
from preshape.models.success_model import SuccessModel
from preshape.paths import project_root
from preshape.perception.object_view import object_cloud, object_patch
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.perception.view_batch import ViewBatch
from preshape.perception.view_choice import load_chosen_view
from preshape.tracking.logged_model import EXAMPLE_VIEW, OUTPUT


class SuccessPredictor(PythonModel):
    """Judges grasps in one view.

    The network is built from its settings. Only classes that the configuration of this checkout names are
    built, whatever the file of a model says.
    """

    def load_context(self, context: PythonModelContext) -> None:
        """Build the network and read its weights.

        Raises:
            InputError: if the settings name what is no part of a network, or the weights do not fit.
        """
        settings = dict(context.model_config)
        _check_targets(settings)
        self._network: SuccessModel = instantiate(settings)
        load_weights(context.artifacts["weights"], self._network)
        self._example = Path(context.artifacts["example"])

    def predict(
        self, context: PythonModelContext, model_input: pd.DataFrame, params: dict[str, Any] | None = None
    ) -> pd.DataFrame:
        """Success probabilities of grasps.

        Args:
            context: where the model's files lie.
            model_input: n grasps, a column for each parameter of theta (camera frame, m and rad).
            params: `view`, the folder of a saved view; or a safetensors file with what the network looks at,
                as in a `ViewBatch` of one view; or `example`, the view that comes with the model.

        Returns:
            n rows with the column `success_prob`.

        Raises:
            InputError: if no view is given, or it cannot be used.
        """
        view = self._view(str((params or {}).get("view", "")))
        theta = torch.tensor(model_input.to_numpy(dtype=float), dtype=torch.float32)
        with torch.inference_mode():
            logits = self._network.head(self._network.features(view), theta)
        return pd.DataFrame({OUTPUT: torch.sigmoid(logits.double()).numpy()})

    def _view(self, chosen: str) -> ViewBatch:
        if chosen == EXAMPLE_VIEW:
            return self._view_of_file(self._example)
        if not chosen:
            fix = 'call predict(grasps, params={"view": "DIR"}) with the folder of a saved view'
            raise InputError("The network judges grasps in a view, but none is given", where="view", fix=fix)
        return (
            self._view_of_file(Path(chosen)) if chosen.endswith(".safetensors") else self._saved_view(chosen)
        )

    def _view_of_file(self, file: Path) -> ViewBatch:
        try:
            parts = load_file(file)
        except (OSError, SafetensorError) as error:
            fix = f"write {', '.join(self._network.looks_at)} with safetensors.torch.save_file"
            raise InputError(f"The view cannot be read: {error}", where=file, fix=fix) from error
        if set(parts) != set(self._network.looks_at):
            fix = f"`{self._network.name}` looks at {', '.join(self._network.looks_at)}: write these"
            raise InputError(f"The view has {', '.join(sorted(parts))}", where=file, fix=fix)
        return _unseen()._replace(**parts)

    def _saved_view(self, folder: str) -> ViewBatch:
        observation = load_chosen_view(folder)
        cloud = object_cloud(segment(observation, SegmentationSettings()))
        patch: Tensor | None = None
        if "patch" in self._network.looks_at:
            patch = torch.from_numpy(object_patch(observation, cloud.centre(observation.camera)))[None]
        return ViewBatch.of([cloud], [observation.camera], patch)


def _unseen() -> ViewBatch:
    """A view of nothing, to be filled with what a network looks at."""
    return ViewBatch(*(torch.zeros(1, *rest) for rest in ((8, 0, 0), (4,), (0, 3), (4,), (4, 4))))


def _check_targets(settings: Mapping[str, Any]) -> None:
    folders = [project_root() / "conf" / group for group in ("model", "robot")]
    known = {
        target
        for folder in folders
        for file in folder.rglob("*.yaml")
        for target in re.findall(r"_target_: *([\w.]+)", file.read_text(encoding="utf-8"))
    }
    foreign = sorted(set(_targets(settings)) - known)
    if foreign:
        fix = "load models that `python src/train.py` of this checkout logged"
        raise InputError(f"The model names {', '.join(foreign)}", where="conf/model and conf/robot", fix=fix)


def _targets(node: Any) -> Iterator[str]:
    """Whatever a configuration wants to have built."""
    if isinstance(node, Mapping):
        if "_target_" in node:
            yield str(node["_target_"])
        for value in node.values():
            yield from _targets(value)
    elif isinstance(node, list | tuple):
        for value in node:
            yield from _targets(value)
