"""Portray all objects of a set on one sheet: `python sim/contact_sheet.py objects=grocery`."""

import preshape.command_line.startup

import logging
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from sim.object_portraits import SheetFile, contact_sheet

log = logging.getLogger(__name__)


@entry_point("contact_sheet")
def main(cfg: DictConfig) -> None:
    """Write one picture of all objects."""
    file = SheetFile(Path(cfg.output), cfg.quality)
    objects = instantiate(cfg.objects.set)
    file.save(contact_sheet(objects, instantiate(cfg.portrait), instantiate(cfg.sheet)))
    log.info("%d objects: %s", len(objects.names), cfg.output)


if __name__ == "__main__":
    main()
