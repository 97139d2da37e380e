"""One training as a user asked for it, alone or as a fold of a sweep that may be started again."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from preshape.data.labelled_data import LabelledData
from preshape.errors import InputError
from preshape.evaluation.fold_summary import summarise
from preshape.evaluation.measured_files import METRICS_FILE
from preshape.files import file_hash, read_json
from preshape.models.success_model import GraspNetwork, SuccessModel
from preshape.provenance import command_line, device_name, git_revision
from preshape.source_digest import source_digest
from preshape.sweeps.fold_table import FoldTable
from preshape.sweeps.run_table import join_table, sweep_folder
from preshape.tracking.logged_model import TrainedModel, seen_parts
from preshape.tracking.tracked_run import (
    MULTIRUN_TAG,
    NoTracking,
    SweepMember,
    TrackedRun,
    Tracking,
    content_digest,
)
from preshape.training import WEIGHTS_FILE, TrainerSettings, is_first_process, keep_files, train

DECISIVE = (
    *("preshape.data.labelled_data", "preshape.measuring"),
    *("preshape.models.callbacks", "preshape.models.lightning_module"),
)
"""Modules whose code decides weights and figures, besides those of the network and the data."""
WITHOUT_INFLUENCE = (
    *("paths", "tracking", "run_name", "split", "fold", "retrain_after_code_changes"),
    *("dataset.data.folder", "dataset.data.views.folder", "dataset.data.views.maker"),
    *("dataset.data.views.max_gigabytes", "dataset.root", "dataset.data.maker"),
)
"""Settings that say where things lie, how fast they are made, or which fold is meant."""


@dataclass(frozen=True)
class TrainingJob:
    """What a user asked for.

    Args:
        name: name of the run.
        folder: where its files go; in a sweep, the folder of its group is the one above.
        about: what the file of the metrics shall say about it; `split` and `fold` at least.
        config: the configuration, resolved.
        unresolved: the same with its references, which do not depend on where the project lies.
        in_sweep: whether it is one of several.
        retrain_after_code_changes: whether a fold is trained again if the code has changed since.
    """

    name: str
    folder: Path
    about: Mapping[str, Any]
    config: Mapping[str, Any]
    unresolved: Mapping[str, Any]
    in_sweep: bool
    retrain_after_code_changes: bool

    def run(
        self, model: GraspNetwork, data: LabelledData, settings: TrainerSettings, tracking: Tracking
    ) -> str:
        """Train and measure, keep both, and say what came out.

        A fold of a sweep that was trained before with the same settings, data and code is not trained again.

        Raises:
            InputError: if the data cannot be used, files cannot be written, or several GPUs are wanted for a
                fold of a sweep.
        """
        if not self.in_sweep:
            data.setup()
            tracking = tracking if is_first_process() else NoTracking()
            with tracking.run(self.name, self.config, _tags(data, settings)) as run:
                description = self._description(model, data, settings)
                result = train(model, data, settings, self.folder, run, description)
                self._keep_model(model, data, run)
            return f"{self.name}: {result.metrics.summary()}; weights: {result.weights}"
        _refuse_several_devices(settings)
        data.setup()
        description = self._description(model, data, settings)
        group, identity = self.folder.parent, description["identity"]
        member = SweepMember(
            name=group.name,
            digest=content_digest((str(group), identity["settings"], identity["data"])),
            member_digest=content_digest(identity),
            trained=self._is_trained(identity),
        )
        sweep = sweep_folder(group.parent, command_line())
        tags = {**_tags(data, settings), "group": group.name, MULTIRUN_TAG: sweep.name}
        with tracking.run(self.folder.name, self.config, tags, member) as run:
            if member.trained:
                outcome = self._had_been_trained(model, data, settings, run)
            else:
                outcome = train(model, data, settings, self.folder, run, description).metrics.summary()
                self._keep_model(model, data, run)
            summary = summarise(group, self._decisive(identity))
            rows, table = join_table(sweep, self.folder, FoldTable())
            if run.parent is not None:
                run.parent.log(summary.scalars(), summary.folds)
                for file in summary.files:
                    run.parent.keep(file)
                run.parent.keep_table(rows, table)
        name = f"{group.name}/{self.folder.name}"
        return f"{name}: {outcome}; weights: {self.folder / WEIGHTS_FILE}; {summary.in_words()}"

    def _had_been_trained(
        self, model: GraspNetwork, data: LabelledData, settings: TrainerSettings, run: TrackedRun
    ) -> str:
        """Make up for what is missing of the run's record, if the files came to their end and it did not."""
        if not run.was_finished:
            scalars = read_json(self.folder / METRICS_FILE)["scalars"].items()
            known = {f"test_{name}": value for name, value in scalars if value is not None}
            run.log(known, settings.learning.iterations)
            keep_files(self.folder, run)
            data.render(with_patches="patch" in model.looks_at)
            self._keep_model(model, data, run)
        return "had been trained before"

    def _keep_model(self, model: GraspNetwork, data: LabelledData, run: TrackedRun) -> None:
        """Keep a network that predicts success, with the first held-out trial as its example."""
        if isinstance(model, SuccessModel):
            example = data.test[[0]]
            run.keep_model(
                TrainedModel(
                    name=self.name,
                    weights=self.folder / WEIGHTS_FILE,
                    settings=self.config["model"],
                    theta_names=data.test.trials.space.names,
                    view=seen_parts(example.view, model.looks_at),
                    theta=example.theta,
                )
            )

    def _description(
        self, model: GraspNetwork, data: LabelledData, settings: TrainerSettings
    ) -> dict[str, Any]:
        """What the file of the metrics says about the job.

        Raises:
            InputError: if the weights to start from cannot be read.
        """
        code = [source_digest(module) for module in (*DECISIVE, *_modules(model, data))]
        return {
            "name": self.name,
            **self.about,
            "identity": {
                "settings": content_digest(_without(self.unresolved, WITHOUT_INFLUENCE)),
                "data": data.data_hash,
                "code": content_digest(code),
                **_identity_of_start(settings.learning.start),
            },
        }

    def _decisive(self, identity: Mapping[str, str]) -> dict[str, str]:
        """The digests in which folds of the sweep have to agree."""
        left_out = () if self.retrain_after_code_changes else ("code",)
        return {name: digest for name, digest in identity.items() if name not in left_out}

    def _is_trained(self, identity: Mapping[str, str]) -> bool:
        """Whether the folder holds the result of just this job."""
        if not (self.folder / METRICS_FILE).is_file() or not (self.folder / WEIGHTS_FILE).is_file():
            return False
        found = read_json(self.folder / METRICS_FILE)
        same_fold = all(found.get(key) == self.about[key] for key in ("split", "fold"))
        return same_fold and self._decisive(identity).items() <= found.get("identity", {}).items()


def _tags(data: LabelledData, settings: TrainerSettings) -> dict[str, str]:
    """By what runs are found: the code, the data, and what computed."""
    return {
        "git_revision": git_revision(),
        "data_hash": data.data_hash,
        "device": device_name(settings.accelerator),
    }


def _modules(*parts: object) -> tuple[str, ...]:
    return tuple(type(part).__module__ for part in parts)


def _identity_of_start(weights: str | None) -> dict[str, str]:
    """Digest of the weights that a training starts from: their file may be another one the next time."""
    if weights is None:
        return {}
    if not Path(weights).is_file():
        raise InputError(
            "There are no weights to learn on from",
            where=weights,
            fix="train them first with `python src/train.py`, or correct learning.settings.start",
        )
    return {"start": file_hash(weights)}


def _refuse_several_devices(settings: TrainerSettings) -> None:
    if settings.devices > 1:
        raise InputError(
            f"A fold of a sweep trains on one device, but {settings.devices} are wanted",
            where="trainer.settings.devices",
            fix="leave it at 1 and let the launcher run several folds at once "
            "(hydra/launcher=joblib or submitit_slurm), or train one network without --multirun",
        )


def _without(config: Mapping[str, Any], keys: tuple[str, ...], prefix: str = "") -> dict[str, Any]:
    return {
        key: _without(value, keys, f"{prefix}{key}.") if isinstance(value, Mapping) else value
        for key, value in config.items()
        if f"{prefix}{key}" not in keys
    }
