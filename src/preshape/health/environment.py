"""Python, the locked packages, PyTorch and what came with the wheels."""

import json
import platform
import re
import sys
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from preshape.health.finding import Finding, Status, probe

SUPPORTED = ((3, 11), (3, 12))


def check_python(running: tuple[int, int] = sys.version_info[:2]) -> Finding:
    """Whether the project knows this Python."""
    here = f"{platform.python_version()} in {sys.prefix}"
    if running in SUPPORTED:
        return Finding("Python", Status.OK, here)
    fix = "rm -rf .venv && make setup PYTHON=python3.12"
    return Finding("Python", Status.FAIL, f"{here}; 3.11 or 3.12 is needed", fix)


def check_packages(lock: Path) -> Finding:
    """Whether the installed packages are those of requirements.lock."""
    locked = dict(re.findall(r"^([\w.-]+)==([^\s;]+)", lock.read_text(encoding="utf-8"), flags=re.MULTILINE))
    installed = {name: _installed_version(name) for name in locked}
    missing = [name for name, found in installed.items() if found is None]
    other = [
        f"{name} {installed[name]} instead of {wanted}"
        for name, wanted in locked.items()
        if installed[name] not in (None, wanted)
    ]
    venv = lock.parent / ".venv"
    if Path(sys.prefix) != venv and missing:
        fix = f"make setup, then use {venv / 'bin' / 'python'}"
    else:
        fix = f"{sys.executable} -m pip install -r {lock}"
    if missing:
        detail = f"{len(missing)} of {len(locked)} missing: {_some(missing)}"
        return Finding("Locked packages", Status.FAIL, detail, fix)
    if other:
        return Finding("Locked packages", Status.WARN, f"{len(other)} differ: {_some(other)}", fix)
    return Finding("Locked packages", Status.OK, f"all {len(locked)} as in {lock.name}")


def check_torch(nvidia: Path = Path("/dev/nvidia0")) -> Finding:
    """Whether PyTorch loads, and uses the graphics card if there is one."""
    code = (
        "import json, torch; cuda = torch.cuda.is_available(); print(json.dumps("
        "{'version': torch.__version__, 'threads': torch.get_num_threads(),"
        " 'gpu': torch.cuda.get_device_name() if cuda else None}))"
    )
    result = probe("-c", code)
    if not result.succeeded:
        return Finding("PyTorch", Status.FAIL, result.text, "make setup")
    facts = json.loads(result.text)
    where = facts["gpu"] or f"CPU, {facts['threads']} threads"
    if facts["gpu"] is None and nvidia.exists():
        return Finding(
            "PyTorch",
            Status.WARN,
            f"{facts['version']} on {where}, though there is an NVIDIA card",
            "install a CUDA build of the locked version (a build +cpu cannot use it), and a recent driver",
        )
    return Finding("PyTorch", Status.OK, f"{facts['version']} on {where}")


def check_robot_data() -> Finding:
    """Whether the Allegro hand of `example-robot-data` is there."""
    spec = find_spec("cmeel")
    parents = [Path(place).parent for place in (spec and spec.submodule_search_locations) or ()]
    hands = "cmeel.prefix/share/example-robot-data/robots/allegro_hand_description/urdf"
    files = [path for parent in parents for path in (parent / hands).glob("*right*.urdf")]
    if files:
        return Finding("Robot data", Status.OK, str(files[0]))
    fix = f"{sys.executable} -m pip install --force-reinstall --no-deps example-robot-data"
    return Finding("Robot data", Status.FAIL, f"no Allegro hand in {hands}", fix)


def _installed_version(name: str) -> str | None:
    try:
        return version(name).split("+")[0]
    except PackageNotFoundError:
        return None


def _some(entries: list[str], shown: int = 3) -> str:
    rest = f" and {len(entries) - shown} more" if len(entries) > shown else ""
    return ", ".join(entries[:shown]) + rest
