"""Names for derived files that change whenever what they are made from changes."""

import hashlib
import json
from functools import cache
from importlib.metadata import version
from typing import Any

from omegaconf import DictConfig, OmegaConf

from preshape.paths import project_root
from preshape.source_digest import source_digest

SOURCES = (
    "sim",
    "src/preshape/geometry",
    "src/preshape/perception",
    "src/preshape/grasps",
    "src/preshape/data",
)
"""Folders whose change may change a trial."""
PACKAGES = (
    *("coacd", "coal", "numpy", "ompl", "open3d", "pin", "sapien", "scipy", "toppra", "torch", "trimesh"),
)
"""Packages whose change may change a trial."""


def fingerprint(*parts: Any, cache: str) -> str:
    """Hash of configuration and values together with the code and packages that turn them into trials.

    Args:
        parts: configuration nodes, or anything that JSON can hold.
        cache: the folder of derived files, whose place decides nothing.
    """
    plain = [
        OmegaConf.to_container(part, resolve=True) if isinstance(part, DictConfig) else part for part in parts
    ]
    text = json.dumps([plain, _source_digest(), {name: version(name) for name in PACKAGES}], sort_keys=True)
    text = text.replace(json.dumps(cache)[1:-1], "cache")
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def code_of(config: Any) -> list[str]:
    """Digests of the code behind all that a configuration names by `_target_`.

    Args:
        config: a configuration node, or what it holds.
    """
    if isinstance(config, DictConfig):
        config = OmegaConf.to_container(config, resolve=True)
    if isinstance(config, list):
        return [digest for entry in config for digest in code_of(entry)]
    if not isinstance(config, dict):
        return []
    own = [source_digest(config["_target_"].rpartition(".")[0])] if "_target_" in config else []
    return own + [digest for entry in config.values() for digest in code_of(entry)]


@cache
def _source_digest() -> str:
    digest = hashlib.sha256()
    for folder in SOURCES:
        for path in sorted((project_root() / folder).rglob("*")):
            if path.is_file() and path.parent.name != "__pycache__":
                digest.update(path.name.encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()
