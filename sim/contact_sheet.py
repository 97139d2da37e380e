"""Portray all objects of a set on one sheet: `python sim/contact_sheet.py objects=grocery`."""

import preshape.startup

import logging
from pathlib import Path

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.entry_point import entry_point
from preshape.files import atomic_path
from sim.object_portraits import contact_sheet

log = logging.getLogger(__name__)


@entry_point("contact_sheet")
def main(cfg: DictConfig) -> None:
    """Write one picture of all objects."""
    objects = instantiate(cfg.objects.set)
    sheet = contact_sheet(objects, instantiate(cfg.portrait), instantiate(cfg.sheet))
    with atomic_path(Path(cfg.output)) as temporary:
        sheet.save(temporary, format="WEBP", quality=cfg.quality, method=6)
    log.info("%d objects: %s", len(objects.names), cfg.output)


if __name__ == "__main__":
    main()
