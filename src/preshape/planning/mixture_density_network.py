"""A prior over theta that looks at the object first: a mixture density network."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float, Float32, Float64
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor, nn

from preshape.errors import InputError
from preshape.files import atomic_path
from preshape.perception.view_batch import ViewBatch
from preshape.planning.prior import MIN_VARIANCE, GraspPrior, in_box

FORMAT = "preshape-prior-network/1"
"""Name and version of the file; raised whenever old files could be misread."""
METADATA = "prior"
"""Entry of the file's metadata that says what it holds; the only one, because several come in any order."""
POINTS = 128
"""Points of an object that are looked at."""
LENGTH_M = 0.1
"""Unit of lengths inside the network."""
INITIAL_SHARE = 0.1
"""Part of the usual random weights with which the last layer begins, so that the object counts little yet."""
AGAIN = "fit it again with `python src/fit_prior.py prior=network`"

Mixtures = tuple[Float[Tensor, "b m"], Float[Tensor, "b m e"], Float[Tensor, "b m e"]]


class MixtureDensityNetwork(nn.Module):
    """From the points of an object to a mixture of m normal distributions over its grasps.

    A mixture density network (Bishop, "Mixture density networks", NCRG/94/004, 1994). It sees the points p of
    the visible surface in the frame of the object's box, q = R^T (p - t), pooled by their maximum, and says
    weights, means and variances of distributions without correlations over what `in_box` makes of a grasp. So
    the density of a grasp is the same wherever object and hand are moved together.

    Args:
        grasp_space: name of the grasp space of theta.
        features: number e of features that `in_box` makes of a grasp.
        components: number m of distributions.
    """

    def __init__(self, grasp_space: str, features: int, components: int) -> None:
        super().__init__()
        self.grasp_space, self.features, self.components = grasp_space, features, components
        self.point_layers = nn.Sequential(nn.Linear(3, 32), nn.ReLU(), nn.Linear(32, 64))
        self.object_layers = nn.Sequential(nn.Linear(64, 64), nn.ReLU())
        self.mixture_layer = nn.Linear(64, components * (1 + 2 * features))

    @classmethod
    def beginning_with(cls, mixture: GraspPrior, generator: torch.Generator) -> "MixtureDensityNetwork":
        """A network to be fitted, with random weights, that says about the same mixture of every object."""
        components, features = mixture.means.shape
        network = cls(mixture.grasp_space, features, components)
        for layer in network.modules():
            if isinstance(layer, nn.Linear):
                nn.init.xavier_uniform_(layer.weight, generator=generator)
                nn.init.zeros_(layer.bias)
        inverse = torch.linalg.inv(mixture.precisions)
        variances = (inverse.mT @ inverse).diagonal(dim1=1, dim2=2)
        log_deviations = (variances - MIN_VARIANCE).clamp_min(MIN_VARIANCE).log() / 2
        said = torch.cat((mixture.log_weights[:, None], mixture.means, log_deviations), dim=1)
        with torch.no_grad():
            network.mixture_layer.weight.mul_(INITIAL_SHARE)
            network.mixture_layer.bias.copy_(said.flatten())
        return network

    def forward(self, points: Float32[Tensor, "b n 3"]) -> Mixtures:
        """Log weights, means and variances of each object's mixture, from `points_in_box`."""
        # The ReLU keeps the order of the points, so it can wait for the maximum.
        pooled = torch.relu(self.point_layers(points).amax(dim=1))
        said = self.mixture_layer(self.object_layers(pooled)).unflatten(1, (self.components, -1))
        weights, means, log_deviations = said.split((1, self.features, self.features), dim=2)
        return weights[:, :, 0].log_softmax(dim=1), means, (2 * log_deviations).exp() + MIN_VARIANCE

    def log_density(
        self, features: Float32[Tensor, "b e"], points: Float32[Tensor, "b n 3"]
    ) -> Float32[Tensor, "b"]:
        """Log density of grasps, each of its own object, up to the constant of `GraspPrior`."""
        log_weights, means, variances = self(points)
        each = ((features[:, None] - means).square() / variances + variances.log()).sum(dim=2)
        return torch.logsumexp(log_weights - each / 2, dim=1)

    @torch.no_grad()
    def in_view(self, view: ViewBatch) -> GraspPrior:
        """The prior over grasps of the object in a view, one in the batch."""
        said = self(points_in_box(view)[:, :POINTS])
        log_weights, means, variances = (part[0].double() for part in said)
        return GraspPrior(self.grasp_space, log_weights, means, variances.rsqrt().diag_embed())

    def write(self, path: str | Path) -> None:
        """Write the network as safetensors, atomically.

        Raises:
            InputError: if the place cannot be written to.
        """
        about = {
            "format": FORMAT,
            "grasp_space": self.grasp_space,
            "features": self.features,
            "components": self.components,
        }
        tensors = {name: tensor.contiguous() for name, tensor in self.state_dict().items()}
        content = save(tensors, metadata={METADATA: json.dumps(about)})
        with atomic_path(path) as temporary:
            temporary.write_bytes(content)

    @classmethod
    def read(cls, path: str | Path) -> "MixtureDensityNetwork":
        """Read a network.

        Raises:
            InputError: if the file is missing, damaged, or no such prior of this version.
        """
        metadata, tensors = _read_tensors(path)
        about = _parsed(metadata.get(METADATA, "{}"))
        if about.get("format") != FORMAT:
            raise InputError(f"The file is no prior in the format {FORMAT}", where=path, fix=AGAIN)
        try:
            with torch.device("meta"):  # takes no memory, whatever sizes the file names
                network = cls(str(about["grasp_space"]), about["features"], about["components"])
            _check(tensors, network.state_dict())
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            raise InputError(
                f"The prior is incomplete or damaged ({error})", where=path, fix=AGAIN
            ) from error
        network.load_state_dict(tensors, assign=True)
        return network.eval().requires_grad_(False)


def points_in_box(view: ViewBatch) -> Float32[Tensor, "b n 3"]:
    """The points of each object in the frame of its box, in units of `LENGTH_M`."""
    points, T_camera_box = view.points.double(), view.T_camera_box.double()
    offsets = points - T_camera_box[:, None, :3, 3]
    return (offsets @ T_camera_box[:, :3, :3] / LENGTH_M).float()


def features_in_box(theta: Float[Tensor, "b d"], view: ViewBatch) -> Float64[Tensor, "b e"]:
    """What `in_box` makes of grasps, each in its own view."""
    return in_box(theta.double(), view.T_camera_box.double())


def _read_tensors(path: str | Path) -> tuple[dict[str, str], dict[str, Tensor]]:
    try:
        with safe_open(path, framework="pt") as file:
            return file.metadata() or {}, {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except FileNotFoundError as error:
        raise InputError("The file does not exist", where=path, fix="check the path") from error
    except OSError as error:
        problem = error.strerror or error
        raise InputError(f"The file cannot be read: {problem}", where=path, fix="check the path") from error
    except (SafetensorError, ValueError, KeyError) as error:
        raise InputError(f"The file is not safetensors: {error}", where=path, fix=AGAIN) from error


def _parsed(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _check(tensors: Mapping[str, Tensor], expected: Mapping[str, Tensor]) -> None:
    def kinds(of: Mapping[str, Tensor]) -> dict[str, tuple[torch.Size, torch.dtype]]:
        return {name: (tensor.shape, tensor.dtype) for name, tensor in of.items()}

    if kinds(tensors) != kinds(expected):
        raise ValueError("its weights do not have the sizes that it names")
    if not all(tensor.isfinite().all() for tensor in tensors.values()):
        raise ValueError("it holds NaN or infinity")
