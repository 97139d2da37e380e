"""Where a result comes from: the command, the code, the versions, the seed, the date."""

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from preshape.paths import project_root

NAMED_PACKAGES = (
    *("torch", "lightning", "numpy", "sapien", "open3d"),
    *("ompl", "pin", "coal", "toppra", "mlflow"),
)
"""Packages whose version can change a number."""
WRITTEN = ("results", "docs", "dvc.lock", "pipelines/*/dvc.lock")
"""What commands themselves write about results, so that it may differ when the next one runs."""
DERIVED = ("paths.cache=", "paths.outputs=")
"""Settings that say where derived files lie."""
TYPED_COMMAND = "PRESHAPE_COMMAND"
"""Environment variable by which the processes of a sweep, which launchers start, know what was typed."""


def provenance(seed: int) -> dict[str, Any]:
    """What every result file starts with."""
    return {
        "command": lasting_command(),
        "git_revision": git_revision(),
        "versions": package_versions(),
        "seed": seed,
        "date": datetime.now(UTC).date().isoformat(),
    }


def command_line() -> str:
    """The command as it can be typed again from the project's folder."""
    return os.environ.get(TYPED_COMMAND) or typed_command()


def lasting_command() -> str:
    """The same without where caches and outputs lie, which decides nothing and differs between machines."""
    return " ".join(word for word in command_line().split(" ") if not word.startswith(DERIVED))


def typed_command() -> str:
    """`command_line` of the process that it was typed for."""
    script = Path(sys.argv[0]).resolve()
    root = project_root()
    name = script.relative_to(root) if script.is_relative_to(root) else script.name
    return " ".join(("python", str(name), *sys.argv[1:]))


def git_revision(root: Path | None = None) -> str:
    """Commit of the code, with `-dirty` if tracked files differ from it on which a result can depend.

    Args:
        root: a checkout; None for the project's own.

    Returns:
        The first 12 digits; `unknown` outside a git checkout.
    """
    root = project_root() if root is None else root
    others = (f":(top,exclude){path}" for path in WRITTEN)
    try:
        commit = _git(root, "rev-parse", "--short=12", "HEAD")
        changed = _git(root, "diff", "--name-only", "HEAD", "--", ":(top)", *others)
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return f"{commit}-dirty" if changed else commit


def _git(root: Path, *arguments: str) -> str:
    command = ["git", *arguments]
    answer = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True, timeout=20)
    return answer.stdout.strip()


def device_name(accelerator: str) -> str:
    """What computes: the graphics card, or the processor."""
    import torch  # takes seconds, which commands that only ask for the revision need not wait

    if accelerator != "cpu" and torch.cuda.is_available():
        return str(torch.cuda.get_device_name())
    return processor_name()


def processor_name() -> str:
    """The processor as it calls itself."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def package_versions() -> dict[str, str]:
    """Versions of Python and of the packages that can change a number, where they are installed."""
    versions = {"python": ".".join(map(str, sys.version_info[:3]))}
    for name in NAMED_PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return versions
