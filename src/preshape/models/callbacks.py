"""What a training shows, keeps track of and survives."""

import logging
from pathlib import Path
from typing import Any

import lightning
from lightning.pytorch.callbacks import Callback
from torch import Tensor

from preshape.files import atomic_path
from preshape.progress import Progress
from preshape.tracking.tracked_run import TrackedRun

log = logging.getLogger(__name__)

SMOOTHING = 0.98
"""Share of the old value in the running mean of the loss."""


class ShowProgress(Callback):
    """Iterations done, time left, loss and validation AUC."""

    def __init__(self) -> None:
        self._progress: Progress | None = None
        self._loss = float("nan")

    def on_train_start(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Begin where an interrupted training ended."""
        total, done = int(trainer.max_steps), trainer.global_step
        self._progress = Progress("Training", total, "iterations", done=done).__enter__()

    def on_train_batch_end(
        self,
        trainer: lightning.Trainer,
        pl_module: lightning.LightningModule,
        outputs: object,
        batch: object,
        batch_idx: int,
    ) -> None:
        """One more."""
        assert self._progress is not None
        assert isinstance(outputs, dict)
        loss = float(outputs["loss"])
        self._loss = loss if self._loss != self._loss else SMOOTHING * self._loss + (1 - SMOOTHING) * loss
        auc = trainer.callback_metrics.get("val_auc")
        validation = "" if auc is None else f", validation AUC {float(auc):.3f}"
        self._progress.advance(1, f"loss {self._loss:.3f}{validation}")

    def teardown(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule, stage: str) -> None:
        """Leave the terminal tidy, also after an interrupt."""
        if self._progress is not None:
            self._progress.__exit__(None, None, None)
            self._progress = None


class TrackCurves(Callback):
    """Sends the curves of every epoch to the tracked run, and remembers them.

    Args:
        run: where they are kept.

    Attributes:
        points: the values after each epoch by their names, with the number of `iteration`s.
    """

    def __init__(self, run: TrackedRun) -> None:
        self._run = run
        self.points: list[dict[str, float]] = []

    def on_train_epoch_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """One point on each curve."""
        values = {name: float(value) for name, value in trainer.callback_metrics.items()}
        values["learning_rate"] = trainer.optimizers[0].param_groups[0]["lr"]
        self._run.log(values, trainer.global_step)
        self.points.append({"iteration": float(trainer.global_step), **values})

    def state_dict(self) -> dict[str, Any]:
        """What a training that goes on needs to know."""
        return {"points": self.points}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Go on from there."""
        self.points = state_dict["points"]


class KeepBest(Callback):
    """Ends a training with the weights that had the lowest validation loss.

    After that a network only becomes surer of what it has seen; its probabilities, and the slopes that a
    planner climbs, get worse.
    """

    def __init__(self) -> None:
        self._loss = float("inf")
        self._iteration = 0
        self._weights: dict[str, Tensor] = {}

    def on_validation_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Remember the weights if they are the best so far."""
        loss = float(trainer.callback_metrics["val_loss"])
        if loss < self._loss:
            self._loss, self._iteration = loss, trainer.global_step
            self._weights = {name: value.clone() for name, value in pl_module.state_dict().items()}

    def on_fit_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Take the best weights, also where an interrupted training had nothing left to do."""
        if self._weights:
            pl_module.load_state_dict(self._weights)
            log.info("Kept the weights of iteration %d, validation loss %.3f", self._iteration, self._loss)

    def state_dict(self) -> dict[str, Any]:
        """What a training that goes on needs to know."""
        return {"loss": self._loss, "iteration": self._iteration, "weights": self._weights}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Go on from there."""
        self._loss, self._iteration = state_dict["loss"], state_dict["iteration"]
        self._weights = state_dict["weights"]


class Resumable(Callback):
    """Saves the state of the training after every epoch, whole or not at all.

    Args:
        path: the file; `Trainer.fit` goes on from there.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def on_train_epoch_end(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Save; of several processes that train together the first one does."""
        if not trainer.is_global_zero:
            trainer.save_checkpoint(self._path)  # writes nothing, but the first one waits for the others here
            return
        with atomic_path(self._path) as temporary:
            trainer.save_checkpoint(temporary)

    def on_save_checkpoint(
        self,
        trainer: lightning.Trainer,
        pl_module: lightning.LightningModule,
        checkpoint: dict[str, Any],
    ) -> None:
        """Note that the epoch is over, which Lightning itself does a little later."""
        for epochs in checkpoint["loops"]["fit_loop"]["epoch_progress"].values():
            epochs["completed"] = epochs["processed"]

    def on_train_start(self, trainer: lightning.Trainer, pl_module: lightning.LightningModule) -> None:
        """Begin the next epoch as if nothing had happened.

        Lightning looks for something to finish in the last one. Where there is no validation, it finds
        another batch.
        """
        trainer.fit_loop.epoch_loop.restarting = False
        trainer.fit_loop._resuming_from_checkpoint = False
