"""Write executed rectangles in the layout of the Cornell data: `python sim/write_cornell.py output=DIR`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point

log = logging.getLogger(__name__)


@entry_point("write_cornell")
def main(cfg: DictConfig) -> None:
    """Make what is missing in the folder."""
    instantiate(cfg.maker)(Path(cfg.output))
    log.info("Images with rectangles: %s", cfg.output)


if __name__ == "__main__":
    main()
