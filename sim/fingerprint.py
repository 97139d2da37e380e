"""Names for derived files that change whenever what they are made from changes."""

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf

from preshape.paths import project_root

SOURCES = (
    "sim",
    "src/preshape/geometry",
    "src/preshape/perception",
    "src/preshape/grasps",
    "src/preshape/data",
)
"""Code whose change may change a trial."""


def fingerprint(*parts: Any) -> str:
    """Hash of configuration and values together with the code that turns them into trials.

    Args:
        parts: configuration nodes, or anything that JSON can hold.
    """
    plain = [
        OmegaConf.to_container(part, resolve=True) if isinstance(part, DictConfig) else part for part in parts
    ]
    text = json.dumps([plain, _source_digest()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def _source_digest() -> str:
    digest = hashlib.sha256()
    for folder in SOURCES:
        for path in sorted((project_root() / folder).rglob("*.py")):
            digest.update(path.name.encode())
            digest.update(Path(path).read_bytes())
    return digest.hexdigest()
