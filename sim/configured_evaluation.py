"""An evaluation as a configuration describes it, kept where an interrupted one goes on."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.files import file_hash
from preshape.source_digest import source_digest
from sim.evaluation import SUMMARY_FILE, evaluate
from sim.evaluation_summary import PlannerSummary, summarise, write_summary
from sim.fingerprint import code_of, fingerprint
from sim.planner_contest import try_planners

ENDLESS = ("scenes", "poses_per_object", "workers")
"""Settings that change how many scenes there are, or who works on them, but no scene."""


def run_evaluation(cfg: DictConfig, output: Path) -> list[PlannerSummary]:
    """Evaluate, write the folder and its summary.

    Args:
        cfg: with `evaluate`, `evaluator`, `laboratory`, `robot`, `weights` and `paths` as in
            `conf/evaluate.yaml`.
        output: the evaluation folder; replaced.

    Raises:
        InputError: if something in the configuration cannot be used, or nothing can be written.
    """
    maker, origin = instantiate(cfg.laboratory.scenes), instantiate(cfg.laboratory.origin)
    settings = instantiate(cfg.evaluate).with_objects(len(maker.names))
    evaluator = OmegaConf.to_container(cfg.evaluator, resolve=True)  # worker processes may lack our resolvers
    decisive = {key: cfg.evaluate[key] for key in cfg.evaluate if key not in ENDLESS}
    hashes = (maker.objects.fingerprint, [file_hash(path) for path in _files(evaluator)])
    code = (source_digest(try_planners.__module__), *code_of(evaluator))
    name = fingerprint(evaluator, OmegaConf.create(decisive), *hashes, code, cache=cfg.paths.cache)
    trials = evaluate(
        partial(instantiate, evaluator),
        origin,
        instantiate(cfg.robot.grasp_space),
        settings,
        parts=Path(cfg.paths.cache) / "evaluate" / name,
        output=output,
    )
    summary = summarise(trials)
    write_summary(output / SUMMARY_FILE, summary, settings.seed)
    return summary


def _files(node: Any) -> Iterator[str]:
    """The files that a configuration names: weights, whose content decides."""
    if isinstance(node, dict | list):
        for entry in node.values() if isinstance(node, dict) else node:
            yield from _files(entry)
    elif isinstance(node, str) and Path(node).is_file():
        yield node
