"""Make the views of a data set before trainings need them: `python src/render.py`."""

import preshape.command_line.startup

import logging
import time

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from preshape.files import write_json
from preshape.provenance import provenance

log = logging.getLogger(__name__)


@entry_point("render")
def main(cfg: DictConfig) -> None:
    """Make what is missing in the cache of the views, and say what there is."""
    data = instantiate(cfg.dataset.data)
    data.setup()
    begin = time.monotonic()
    data.render(with_patches=cfg.patches)
    parts = (data.train, data.validation, data.test)
    scenes = len({scene for part in parts for scene in part.trials.scene_ids.tolist()})
    made = {"data_hash": data.data_hash, "scenes": scenes, "patches": cfg.patches}
    write_json(cfg.output, {**provenance(cfg.seed), **made, "seconds": time.monotonic() - begin})
    log.info("The views of %d scenes are there: %s", scenes, cfg.output)


if __name__ == "__main__":
    main()
