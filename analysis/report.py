"""Make pages and result files: `python analysis/report.py report=demo`."""

import preshape.command_line.startup

import logging

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point

log = logging.getLogger(__name__)


@entry_point("report")
def main(cfg: DictConfig) -> None:
    """Write the chosen report and say where it lies."""
    log.info("%s", instantiate(cfg.report).write())


if __name__ == "__main__":
    main()
