"""How networks learn: loss, Adam, step schedule (paper, sections 3.3 and 4.2)."""

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Literal

import lightning
import torch
from jaxtyping import Float
from lightning.pytorch.utilities.types import OptimizerLRSchedulerConfig
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits
from torch.optim import Optimizer
from torch.optim.lr_scheduler import LRScheduler, MultiStepLR
from torchmetrics.functional.classification import binary_auroc

from preshape.data.grasp_dataset import GraspBatch
from preshape.models.one_cycle import one_cycle
from preshape.models.regression_cnn import RegressionCNN
from preshape.models.success_model import GraspNetwork, SuccessModel

Schedule = Literal["steps", "one_cycle"]


@dataclass(frozen=True)
class LearningSettings:
    """How the weights are fitted.

    Args:
        iterations: number of batches.
        learning_rate: of Adam, at its highest.
        schedule: `steps`, the paper's: a tenth after each third of the iterations; or `one_cycle`: up over
            the first tenth of the iterations and down to nothing along a cosine (Smith and Topin 2018).
        weight_decay: decoupled from the gradients (Loshchilov and Hutter 2019); 0 is the paper's Adam.
        seed: seed of dropout.
        start: file of weights from which the network learns on; None for its random ones.
    """

    iterations: int
    learning_rate: float
    schedule: Schedule
    weight_decay: float
    seed: int
    start: str | None = None


class GraspLightningModule(lightning.LightningModule, ABC):
    """A network in training.

    Args:
        model: the network.
        settings: how it learns.
    """

    def __init__(self, model: GraspNetwork, settings: LearningSettings) -> None:
        super().__init__()
        # PyTorch's own annotations leave memory_format out
        self.model = model.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self.settings = settings
        self.save_hyperparameters(asdict(settings), logger=False)

    @abstractmethod
    def loss(self, batch: GraspBatch) -> Float[Tensor, ""]:
        """What the weights make small."""

    def on_train_epoch_start(self) -> None:
        """Make batches and dropout functions of seed and epoch: an interrupted training goes on alike.

        Processes that train together have batches of their own.
        """
        loader = self.trainer.train_dataloader
        assert loader is not None, "Lightning makes it before the first epoch"
        number = self.current_epoch * self.trainer.world_size + self.global_rank
        loader.sampler.begin_epoch(number)
        torch.manual_seed(self.settings.seed + 7919 * (1 + number))

    def training_step(self, batch: GraspBatch) -> Float[Tensor, ""]:
        """Loss of a batch."""
        loss = self.loss(batch)
        self.log("train_loss", loss, on_step=False, on_epoch=True, batch_size=len(batch.label))
        return loss

    def configure_optimizers(self) -> OptimizerLRSchedulerConfig:
        """Adam with a learning rate that changes from batch to batch."""
        settings = self.settings
        optimizer = torch.optim.AdamW(
            self.model.parameters(), lr=settings.learning_rate, weight_decay=settings.weight_decay
        )
        schedule = _schedule(optimizer, settings)
        return {"optimizer": optimizer, "lr_scheduler": {"scheduler": schedule, "interval": "step"}}


def _schedule(optimizer: Optimizer, settings: LearningSettings) -> LRScheduler:
    if settings.schedule == "one_cycle":
        # one more, because the scheduler is also asked after the last batch
        return one_cycle(optimizer, settings.learning_rate, settings.iterations + 1)
    third = settings.iterations // 3
    return MultiStepLR(optimizer, milestones=[third, 2 * third], gamma=0.1)


class SuccessLearning(GraspLightningModule):
    """A success network in training, by cross entropy (equation 2).

    Args:
        model: the network.
        settings: how it learns.
    """

    def __init__(self, model: SuccessModel, settings: LearningSettings) -> None:
        super().__init__(model, settings)
        self._validation: list[tuple[Tensor, Tensor]] = []

    def forward(self, batch: GraspBatch) -> Float[Tensor, "b"]:
        """Logits of a batch."""
        logits: Tensor = self.model(batch.view, batch.theta)
        return logits

    def loss(self, batch: GraspBatch) -> Float[Tensor, ""]:
        """Cross entropy of a batch; where there are several networks in one, the mean of theirs."""
        logits = self.model.member_logits(batch.view, batch.theta)
        return binary_cross_entropy_with_logits(logits, batch.label.expand_as(logits))

    def validation_step(self, batch: GraspBatch) -> None:
        """Collect the logits of the validation trials."""
        self._validation.append((self(batch), batch.label))

    def on_validation_epoch_end(self) -> None:
        """Log cross entropy and area under the ROC curve of all validation trials together."""
        logits, labels = (torch.cat(parts) for parts in zip(*self._validation, strict=True))
        self._validation.clear()
        self.log("val_loss", binary_cross_entropy_with_logits(logits, labels))
        self.log("val_auc", binary_auroc(logits, labels.int()))


class RegressionLearning(GraspLightningModule):
    """The regression network in training, by least squares and ridge regression (section 4.2).

    It learns from whatever trials it is given; they should all have lifted.

    Args:
        model: the network.
        settings: how it learns.
    """

    def __init__(self, model: RegressionCNN, settings: LearningSettings) -> None:
        super().__init__(model, settings)

    def forward(self, batch: GraspBatch) -> Float[Tensor, "b d"]:
        """Grasps predicted for the views of a batch."""
        theta: Tensor = self.model(batch.view)
        return theta

    def loss(self, batch: GraspBatch) -> Float[Tensor, ""]:
        """Squared error of a batch, with ridge regression."""
        loss: Tensor = self.model.loss(self(batch), batch.theta)
        return loss

    def validation_step(self, batch: GraspBatch) -> None:
        """Log the mean loss of the validation trials."""
        self.log("val_loss", self.loss(batch), batch_size=len(batch.label))


def learning_of(model: GraspNetwork, settings: LearningSettings) -> GraspLightningModule:
    """A network in training in the way of its kind."""
    if isinstance(model, RegressionCNN):
        return RegressionLearning(model, settings)
    assert isinstance(model, SuccessModel)
    return SuccessLearning(model, settings)
