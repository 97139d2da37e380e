"""Rounds of training, comparing planners, and executing grasps that are then learned from."""

import logging
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf, open_dict

from preshape.data.joined_tables import joined
from preshape.data.tables import data_hash, read_data_set, write_data_set
from preshape.evaluation.measured_files import METRICS_FILE
from preshape.files import read_json, write_json
from preshape.provenance import provenance
from preshape.tracking.tracked_run import UntrackedRun
from preshape.training import WEIGHTS_FILE, train
from sim.configured_evaluation import run_evaluation
from sim.evaluation_summary import PlannerSummary
from sim.fingerprint import code_of

log = logging.getLogger(__name__)

DONE_FILE = "training.json"


@dataclass(frozen=True)
class Round:
    """What came of one round.

    Args:
        number: 1 for the training from the data set alone.
        trials: executed trials of its table, those held out included.
        added: what the grasps came to that were added for it; None in the first.
        auc: AUC on the held-out trials, with its interval.
        planners: how the planners did with its network.
    """

    number: int
    trials: int
    added: PlannerSummary | None
    auc: dict[str, float]
    planners: tuple[PlannerSummary, ...]

    def __str__(self) -> str:
        return f"round {self.number}: {', '.join(map(str, self.planners))}"

    def to_dict(self) -> dict[str, Any]:
        """The round as it stands in the result file."""
        return {
            "round": self.number,
            "trials": self.trials,
            "added": None if self.added is None else asdict(self.added),
            "auc": self.auc,
            "planners": {planner.planner: asdict(planner) for planner in self.planners},
        }


def improve(cfg: DictConfig, folder: Path) -> list[Round]:
    """Do all rounds, and write each as soon as it is done; what is finished already is not done again.

    The data set that the first round learns from is never altered: every other round has a folder with its
    own tables, which begin with those of the round before.

    Args:
        cfg: as in `conf/improve.yaml`.
        folder: where rounds and the result file go.

    Raises:
        InputError: if something in the configuration cannot be used, or nothing can be written.
    """
    data, rounds = Path(cfg.dataset.data.folder), list[Round]()
    added = None
    for number in range(1, cfg.rounds + 1):
        place = folder / f"round_{number}"
        if rounds:
            added = _acquire(cfg, _weights(cfg, folder, number - 1), number - 1, place)
            data = _extend(cfg, data, place)
        metrics = _train(cfg, data, _network(cfg, folder, number))
        stage = _stage(cfg, {"weights": str(_weights(cfg, folder, number))})
        planners = run_evaluation(stage, place / "evaluation")
        trials = read_data_set(data, instantiate(cfg.robot.grasp_space))[1]
        rounds.append(Round(number, len(trials.executed), added, metrics["auc"], tuple(planners)))
        log.info("Round %d of %d. %s", number, cfg.rounds, rounds[-1])
        content = {"acquisition": cfg.acquisition.name, "rounds": [done.to_dict() for done in rounds]}
        write_json(folder / "improvement.json", provenance(cfg.seed) | content)
    return rounds


def _network(cfg: DictConfig, folder: Path, number: int) -> Path:
    """Folder of a round's training."""
    if number == 1 and cfg.first_training is not None:
        return Path(cfg.first_training)
    return folder / f"round_{number}" / "network"


def _weights(cfg: DictConfig, folder: Path, number: int) -> Path:
    return _network(cfg, folder, number) / WEIGHTS_FILE


def _train(cfg: DictConfig, data: Path, folder: Path) -> dict[str, Any]:
    """Metrics of a training, which is only done if it has not been, with the same data, settings and code."""
    if cfg.first_training is not None and folder == Path(cfg.first_training):
        return read_json(folder / METRICS_FILE)
    stage = _stage(cfg, {"dataset": {"data": {"folder": str(data)}}})
    parts = {
        name: OmegaConf.to_container(stage[name], resolve=True) for name in ("model", "dataset", "trainer")
    }
    decisive = {"data_hash": data_hash(data), "seed": cfg.seed, "code": code_of(parts), **parts}
    done = folder / DONE_FILE
    if not (done.is_file() and read_json(done) == decisive):
        torch.manual_seed(cfg.seed)
        model, module = instantiate(parts["model"]), instantiate(parts["dataset"]["data"])
        train(model, module, instantiate(parts["trainer"]["settings"]), folder, UntrackedRun())
        write_json(done, decisive)
    return read_json(folder / METRICS_FILE)


def _acquire(cfg: DictConfig, weights: Path, number: int, place: Path) -> PlannerSummary:
    """Execute grasps on objects that may be learned from, and keep them in `place/acquired`."""
    name = cfg.acquisition.name
    held_out = (cfg.objects.test or ()) if cfg.split == "objects" else ()
    learned = [known for known in instantiate(cfg.objects.set).names if known not in held_out]
    settings = {
        "scenes": cfg.acquired_scenes,
        "seed": cfg.acquired_seed + number - 1,
        "poses_per_object": None,
        "every_grasp_of": [name],
    }
    stage = _stage(
        cfg,
        {"weights": str(weights), "evaluate": settings, "laboratory": {"scenes": {"only": learned}}},
        planners={name: OmegaConf.to_container(cfg.acquisition, resolve=True)},
    )
    log.info("Acquiring grasps by %s on %d scenes", name, cfg.acquired_scenes)
    return run_evaluation(stage, place / "acquired")[0]


def _extend(cfg: DictConfig, data: Path, place: Path) -> Path:
    """The data set with the acquired grasps behind it, in a folder of its own."""
    space = instantiate(cfg.robot.grasp_space)
    sets = (read_data_set(folder, space) for folder in (data, place / "acquired"))
    write_data_set(place / "data", *joined(*sets))
    return place / "data"


def _stage(cfg: DictConfig, changes: dict[str, Any], **replaced: Any) -> DictConfig:
    """The configuration with changes, and with nodes that are replaced as a whole."""
    stage = cfg.copy()
    with open_dict(stage):
        for name, node in replaced.items():
            stage[name] = node
        stage.merge_with(changes)
    return stage
