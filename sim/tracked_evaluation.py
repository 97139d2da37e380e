"""One evaluation as a user asked for it, alone or as a run of a sweep, and its record."""

from pathlib import Path
from typing import Any

from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.provenance import command_line, device_name, git_revision
from preshape.sweeps.run_table import join_table, sweep_folder
from preshape.tracking.tracked_run import MULTIRUN_TAG, SweepMember, Tracking, content_digest
from sim.configured_evaluation import run_evaluation
from sim.evaluation import SUMMARY_FILE
from sim.evaluation_summary import PlannerSummary
from sim.planner_table import PlannerTable


def tracked_evaluation(cfg: DictConfig, output: Path, sweeps: Path | None) -> list[PlannerSummary]:
    """Evaluate, keep a record of it, and put it into the table of its sweep.

    Args:
        cfg: as in `conf/evaluate.yaml`.
        output: the evaluation folder; replaced.
        sweeps: of one of several runs, the folder with the runs of all sweeps; None for a run alone.

    Raises:
        InputError: if something in the configuration cannot be used, or nothing can be written.
    """
    config: dict[str, Any] = OmegaConf.to_container(cfg, resolve=True)  # type: ignore[assignment]
    tags = {"git_revision": git_revision(), "device": device_name("cpu")}
    sweep = None if sweeps is None else sweep_folder(sweeps, command_line())
    member = None
    if sweep is not None:
        tags[MULTIRUN_TAG] = sweep.name
        member = SweepMember(sweep.name, content_digest(str(sweep)), content_digest(config), trained=False)
    tracking: Tracking = instantiate(cfg.tracking)
    with tracking.run(output.name, config, tags, member) as run:
        summary = run_evaluation(cfg, output)
        run.log(_figures(summary), step=0)
        run.keep(output / SUMMARY_FILE)
        if sweep is not None:
            table = join_table(sweep, output, PlannerTable())
            if run.parent is not None:
                run.parent.keep_table(*table)
    return summary


def _figures(summary: list[PlannerSummary]) -> dict[str, float]:
    """Figures by planner and name: `inference_rate`."""
    return {
        f"{planner.planner}_{name}": float(getattr(planner, name))
        for planner in summary
        for name in ("executed", "lifted", "rate", "low", "high", "predicted")
    }
