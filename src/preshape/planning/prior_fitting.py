"""How priors over theta are fitted to grasps that lifted."""

import logging
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from jaxtyping import Float32, Float64
from sklearn.mixture import GaussianMixture
from torch import Tensor

from preshape.data.grasp_dataset import GraspBatch
from preshape.errors import InputError
from preshape.grasps.space import GraspSpace
from preshape.models.one_cycle import one_cycle
from preshape.planning.mixture_density_network import (
    POINTS,
    MixtureDensityNetwork,
    features_in_box,
    points_in_box,
)
from preshape.planning.prior import MIN_VARIANCE, GraspPrior, in_box
from preshape.planning.threads import one_thread
from preshape.progress import Progress

log = logging.getLogger(__name__)


class PriorFit(Protocol):
    """Fits one kind of prior."""

    def fitted(
        self, train: GraspBatch, held_out: GraspBatch | None, space: GraspSpace
    ) -> GraspPrior | MixtureDensityNetwork:
        """The prior over grasps like those given.

        Args:
            train: grasps that lifted.
            held_out: others, of other scenes, by whose likelihood the fit is judged; None for no judgement.
            space: what theta means.

        Raises:
            InputError: if there are too few grasps.
        """


@dataclass(frozen=True)
class MixtureFit:
    """One Gaussian mixture for all objects.

    Args:
        components: number of distributions.
        seed: seed of the fit.
    """

    components: int
    seed: int

    def fitted(self, train: GraspBatch, held_out: GraspBatch | None, space: GraspSpace) -> GraspPrior:
        """See `PriorFit`."""
        prior = fit_mixture(
            train.theta.double(),
            train.view.T_camera_box.double(),
            space,
            components=self.components,
            seed=self.seed,
        )
        if held_out is not None:
            log.info("Mixture: mean log density of held-out grasps %.2f", _mean_log_density(prior, held_out))
        return prior


@dataclass(frozen=True)
class NetworkFit:
    """A mixture for each object, said by a network that looks at its points.

    The network begins as the Gaussian mixture that suits all objects, and maximises the mean log density of
    the grasps. Of its states at every check, that with the highest density of the held-out grasps is taken,
    or the last one if none are held out. The same seed gives the same network to the bit.

    Args:
        components: number of distributions.
        iterations: number of batches.
        batch_size: grasps per batch.
        learning_rate: of AdamW, at the highest point of its cycle.
        weight_decay: decoupled weight decay.
        check_every: batches between two looks at the held-out grasps.
        seed: seed of the initial weights and of the batches.
    """

    components: int
    iterations: int
    batch_size: int
    learning_rate: float
    weight_decay: float
    check_every: int
    seed: int

    def fitted(
        self, train: GraspBatch, held_out: GraspBatch | None, space: GraspSpace
    ) -> MixtureDensityNetwork:
        """See `PriorFit`."""
        mixture = MixtureFit(self.components, self.seed).fitted(train, held_out, space)
        generator = torch.Generator().manual_seed(self.seed)
        with one_thread():  # sums over several threads would depend on how many there are
            network = MixtureDensityNetwork.beginning_with(mixture, generator)
            best = self._climb(network, _Examples.of(train), held_out, generator)
        if held_out is not None:
            log.info("Network: mean log density of held-out grasps %.2f", best)
        return network.requires_grad_(False)

    def _climb(
        self,
        network: MixtureDensityNetwork,
        train: "_Examples",
        held_out: GraspBatch | None,
        generator: torch.Generator,
    ) -> float:
        """Fit a network in place; the highest mean log density of the held-out grasps."""
        judges = None if held_out is None else _Examples.of(held_out).first_points()
        optimizer = torch.optim.AdamW(
            network.parameters(), self.learning_rate, weight_decay=self.weight_decay
        )
        cycle = one_cycle(optimizer, self.learning_rate, self.iterations)
        best, kept = float("-inf"), network.state_dict()
        with Progress("Fitting the prior", self.iterations, "batches") as progress:
            for batch in range(1, self.iterations + 1):
                optimizer.zero_grad()
                density = train.drawn(self.batch_size, generator).mean_log_density(network)
                torch.autograd.backward(-density)
                optimizer.step()
                cycle.step()
                progress.advance()
                if judges is None or (batch % self.check_every and batch < self.iterations):
                    continue
                with torch.no_grad():
                    judged = judges.mean_log_density(network).item()
                if judged > best:
                    best = judged
                    kept = {name: part.detach().clone() for name, part in network.state_dict().items()}
        network.load_state_dict(kept)
        return best


@dataclass(frozen=True, eq=False)
class _Examples:
    """Grasps as the network sees them: features, and the points of each one's object, all of them or some."""

    features: Float32[Tensor, "b e"]
    points: Float32[Tensor, "b n 3"]

    @classmethod
    def of(cls, grasps: GraspBatch) -> "_Examples":
        return cls(features_in_box(grasps.theta, grasps.view).float(), points_in_box(grasps.view))

    def first_points(self) -> "_Examples":
        """With the points that a planner's view has."""
        return _Examples(self.features, self.points[:, :POINTS])

    def drawn(self, count: int, generator: torch.Generator) -> "_Examples":
        """Random grasps, with other points of their objects each time."""
        rows = torch.randint(len(self.features), (count, 1), generator=generator)
        columns = torch.randperm(self.points.shape[1], generator=generator)[:POINTS]
        return _Examples(self.features[rows[:, 0]], self.points[rows, columns])

    def mean_log_density(self, network: MixtureDensityNetwork) -> Float32[Tensor, ""]:
        return network.log_density(self.features, self.points).mean()


def fit_mixture(
    theta: Float64[Tensor, "n d"],
    T_camera_box: Float64[Tensor, "n 4 4"],
    space: GraspSpace,
    *,
    components: int,
    seed: int,
) -> GraspPrior:
    """The Gaussian mixture that fits given grasps best, each with the box of its own object.

    Raises:
        InputError: if there are fewer grasps than distributions.
    """
    if len(theta) < components:
        raise InputError(
            f"{len(theta)} grasps cannot make a mixture of {components} distributions",
            where="components of the prior",
            fix="choose fewer, or a larger data set",
        )
    features = in_box(theta, T_camera_box).numpy()
    mixture = GaussianMixture(components, reg_covar=MIN_VARIANCE, random_state=seed).fit(features)
    parts = (np.log(mixture.weights_), mixture.means_, mixture.precisions_cholesky_)
    return GraspPrior(space.name, *(torch.from_numpy(part) for part in parts))


def _mean_log_density(prior: GraspPrior, grasps: GraspBatch) -> float:
    boxes = grasps.view.T_camera_box.double()
    return prior.log_density(grasps.theta.double(), boxes).mean().item()
