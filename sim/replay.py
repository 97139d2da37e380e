"""Repeat recorded trials and film them: `python sim/replay.py trials=[12,40]`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig, ListConfig

from preshape.command_line.entry_point import entry_point
from preshape.data.tables import read_data_set
from preshape.errors import InputError
from sim.recorder import Recorder
from sim.repetition import find_trials, repeat

log = logging.getLogger(__name__)


@entry_point("replay")
def main(cfg: DictConfig) -> None:
    """Write an animation of each trial and say whether it ended as recorded."""
    laboratory, settings, output = instantiate(cfg.laboratory), instantiate(cfg.recorder), Path(cfg.output)
    scenes, table = read_data_set(cfg.table, laboratory.space)
    numbers = cfg.trials if isinstance(cfg.trials, ListConfig) else [cfg.trials]
    if not numbers:
        raise InputError("No trial is named", where="trials", fix="give numbers, such as trials=[43]")
    for trial in find_trials(table, numbers):
        recorder = Recorder(settings)
        outcome = repeat(laboratory, scenes, trial, recorder).outcome
        caption = f"{trial.object_id}: {outcome}"
        if recorder.frames:
            recorder.save_animation(output / f"{trial.trial_id}.webp", caption)
        agreement = "as recorded" if outcome == trial.outcome else f"recorded as {trial.outcome}"
        log.info("Trial %d (%s): %s, %s", trial.trial_id, trial.object_id, outcome, agreement)
    log.info("Films: %s", output)


if __name__ == "__main__":
    main()
