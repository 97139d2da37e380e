"""Export a trained network as ONNX: `python src/export.py model=config_cnn weights=FILE.safetensors`."""

import preshape.command_line.startup

import logging

from hydra.utils import instantiate
from omegaconf import DictConfig

from preshape.command_line.entry_point import entry_point
from preshape.models.checkpoints import load_weights
from preshape.models.onnx_export import export_onnx

log = logging.getLogger(__name__)


@entry_point("export")
def main(cfg: DictConfig) -> None:
    """Load the weights into the network of the configuration and write both as one file."""
    model = instantiate(cfg.model)
    load_weights(cfg.weights, model)
    export_onnx(cfg.output, model, cfg.grasps)
    log.info("%s as ONNX: %s", model.name, cfg.output)


if __name__ == "__main__":
    main()
