"""Detect grasps in held-out images of the Cornell data: `python src/detect.py dataset.root=DIR`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.command_line.entry_point import entry_point
from preshape.cornell.data_module import CornellDataModule
from preshape.cornell.protocols import evaluate_folds, result_rows
from preshape.cornell.result_file import merge_rows, summary
from preshape.models.success_model import SuccessModel
from preshape.provenance import git_revision

log = logging.getLogger(__name__)


@entry_point("detect")
def main(cfg: DictConfig) -> None:
    """Plan rectangles with the weights of every fold, judge them, and keep the figures."""

    def parts(split: str, fold: int) -> tuple[CornellDataModule, SuccessModel]:
        cfg.split, cfg.fold = split, fold
        return instantiate(cfg.dataset.data), instantiate(cfg.model)

    config = OmegaConf.to_container(cfg, resolve=True)
    with instantiate(cfg.tracking).run(f"detect_{cfg.name}", config, {"git_revision": git_revision()}) as run:
        outcomes = evaluate_folds(Path(cfg.runs), cfg.splits, parts, instantiate(cfg.detector))
        rows = result_rows(cfg.name, outcomes, cfg.seed)
        merge_rows(Path(cfg.output), rows, cfg.seed)
        run.log({f"{row['folds']}_{row['metric']}": row["value"] for row in rows}, 0)
        run.keep(Path(cfg.output))
    log.info("%s: %s", summary(rows), cfg.output)


if __name__ == "__main__":
    main()
