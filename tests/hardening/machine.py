"""Run every command on a machine that refuses, and count what happens: `python tests/hardening/machine.py`.

As root on Linux, because it mounts small disks and runs commands as a user who may not read or write. Only
cases whose command line holds one of the texts that follow the command are run, if there are any.
"""

import ctypes
import logging
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "fixtures")]

from cases import Case, Commands  # noqa: E402
from misuse import Outcome, import_all, run_case, table  # noqa: E402
from places import make_inputs  # noqa: E402

LEFT_KB = (0, 16, 64)
"""Room on the small disk, which is used up while the run is set up, or while it writes."""
DISK_KB = 1024
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH = 24, 1, 2

log = logging.getLogger(__name__)


def main() -> None:
    """Run all cases and write a table of the kinds."""
    logging.basicConfig(format="%(message)s", level=logging.INFO, stream=sys.stdout)
    import_all()
    texts = sys.argv[1:]
    with tempfile.TemporaryDirectory(prefix="machine") as folder:
        inputs, work = Path(folder) / "inputs", Path(folder) / "work"
        for place in (inputs, work):
            place.mkdir()
        make_inputs(inputs)
        commands = Commands(inputs, work)
        outcomes = [
            run_in(left_kb, case, inputs, work)
            for case, left_kb in situations(commands)
            if not texts or any(text in str(case) for text in texts)
        ]
    log.info("%s", table(outcomes))
    sys.exit(any(outcome.faults for outcome in outcomes))


def situations(commands: Commands) -> Iterator[tuple[Case, int | None]]:
    """All cases, each with the room on the small disk (kB); None if permissions are what refuses."""
    work = commands.work
    for case in (*unwritable_cases(commands, work / "locked"), *unreadable_cases(commands, work / "secret")):
        yield case, None
    for left_kb in LEFT_KB:
        for case in full_disk_cases(commands, work / "disk", left_kb):
            yield case, left_kb


def run_in(left_kb: int | None, case: Case, inputs: Path, work: Path) -> Outcome:
    """Run a case without permissions, or with a small disk."""
    if left_kb is None:
        return run_case(case, inputs, work, obey_permissions)
    with small_disk(work / "disk", left_kb):
        return run_case(case, inputs, work)


def obey_permissions() -> None:
    """Give up root's right to read and write whatever the permissions say; other users have none."""
    if os.geteuid() != 0:
        return
    libc = ctypes.CDLL(None, use_errno=True)

    class Header(ctypes.Structure):
        _fields_ = (("version", ctypes.c_uint32), ("pid", ctypes.c_int))

    class Sets(ctypes.Structure):
        _fields_ = (
            ("effective", ctypes.c_uint32),
            ("permitted", ctypes.c_uint32),
            ("inheritable", ctypes.c_uint32),
        )

    for capability in (CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH):
        libc.prctl(PR_CAPBSET_DROP, capability, 0, 0, 0)
    header, sets = Header(0x20080522, 0), (Sets * 2)()
    libc.capget(ctypes.byref(header), sets)
    kept = ~((1 << CAP_DAC_OVERRIDE) | (1 << CAP_DAC_READ_SEARCH)) & 0xFFFFFFFF
    sets[0].effective &= kept
    sets[0].permitted &= kept
    if libc.capset(ctypes.byref(header), sets) != 0:
        raise OSError(ctypes.get_errno(), "capset")


@contextmanager
def small_disk(place: Path, left_kb: int) -> Iterator[None]:
    """A file system of a megabyte with so much room left."""
    place.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_KB}k", "tmpfs", place], check=True)
    try:
        (place / "filling").write_bytes(bytes(1024 * (DISK_KB - left_kb)))
        yield
    finally:
        subprocess.run(["umount", place], check=True)


def unwritable_cases(commands: Commands, locked: Path) -> Iterator[Case]:
    """Everything that a command writes, in a folder that may not be written to."""
    locked.mkdir(mode=0o500)
    for command, arguments, setting, name in written(commands):
        yield Case("read-only folder", command, (*arguments, f"{setting}={locked / name}"))


def full_disk_cases(commands: Commands, disk: Path, left_kb: int) -> Iterator[Case]:
    """The same on a disk without room."""
    for command, arguments, setting, name in written(commands):
        kind = f"full disk, {left_kb} kB left"
        yield Case(kind, command, (*arguments, f"{setting}={disk / name}"), may_succeed=left_kb > 0)


def written(commands: Commands) -> Iterator[tuple[str, tuple[str, ...], str, str]]:
    """Command, arguments, setting and name of everything that is written."""
    usual = commands.usual
    for command in usual:
        arguments = usual[command] if command != "analysis/report.py" else demo(commands)
        yield command, arguments, "paths.outputs", "outputs"
    mlflow = tuple(argument for argument in usual["src/train.py"] if argument != "tracking=none")
    for setting, name in (("tracking.database", "mlflow.db"), ("tracking.artifacts", "artifacts")):
        others = {"tracking.database", "tracking.artifacts"} - {setting}
        rest = (f"{other}={commands.work / 'outputs' / other}" for other in others)
        yield "src/train.py", (*mlflow, *rest), setting, name
    cached = ("src/train.py", "sim/collect.py", "sim/evaluate.py", "src/fit_prior.py", "sim/sensitivity.py")
    for command in cached:
        yield command, usual[command], "paths.cache", "cache"
    for command, name in (
        ("src/plan.py", "plan"),
        ("src/export.py", "network.onnx"),
        ("src/fit_prior.py", "prior.json"),
        ("sim/replay.py", "films"),
        ("sim/sensitivity.py", "sensitivity.json"),
        ("sim/contact_sheet.py", "sheet.webp"),
        ("sim/last_frames.py", "frames"),
        ("sim/write_cornell.py", "cornell"),
    ):
        yield command, usual[command], "output", name
    yield "sim/collect.py", usual["sim/collect.py"], "collect.output", "table"
    yield "analysis/report.py", demo(commands), "report.output", "demo.html"
    for key in ("output", "card", "page"):
        yield "analysis/report.py", dataset(commands), f"report.{key}", key


def unreadable_cases(commands: Commands, secret: Path) -> Iterator[Case]:
    """Files that may not be read."""
    secret.mkdir()
    plan, inputs = commands.usual["src/plan.py"], commands.inputs
    with_prior = (*plan, "planner.prior.weight=1")
    readable: tuple[tuple[str, tuple[str, ...], str, Path], ...] = (
        ("src/plan.py", plan, "rgb_file", inputs / "view" / "rgb.png"),
        ("src/plan.py", plan, "depth_file", inputs / "depth.npy"),
        ("src/plan.py", plan, "camera_file", inputs / "view" / "camera.json"),
        ("src/plan.py", plan, "weights", inputs / "palm_points.safetensors"),
        ("src/plan.py", with_prior, "planner.prior.file", inputs / "prior.json"),
        ("src/plan.py", with_prior, "planner.prior.file", inputs / "prior.safetensors"),
        ("src/export.py", commands.usual["src/export.py"], "weights", inputs / "config_cnn.safetensors"),
        ("src/train.py", commands.usual["src/train.py"], "dataset.data.folder", inputs / "table"),
        ("sim/replay.py", commands.usual["sim/replay.py"], "table", inputs / "table"),
        ("src/detect.py", commands.usual["src/detect.py"], "dataset.root", inputs / "cornell"),
        ("sim/write_cornell.py", commands.usual["sim/write_cornell.py"], "maker.table", inputs / "table"),
        (
            "sim/collect.py",
            (*commands.usual["sim/collect.py"], "objects=mesh_folder"),
            "objects.root",
            inputs / "meshes",
        ),
        ("analysis/report.py", demo(commands), "report.evaluation", inputs / "evaluation"),
        ("analysis/report.py", dataset(commands), "report.families", inputs / "grocery.csv"),
    )
    for number, (command, arguments, setting, good) in enumerate(readable):
        for what, lock in (("unreadable file", _lock_files), ("unreadable folder", _lock_folder)):
            if what == "unreadable folder" and good.is_file():
                continue
            copy = secret / f"{number}_{what.split()[-1]}" / good.name
            subprocess.run(["mkdir", "-p", copy.parent], check=True)
            subprocess.run(["cp", "-r", good, copy.parent], check=True)
            sidecar = good.with_name(f"{good.name}.json")
            if sidecar.is_file():
                subprocess.run(["cp", sidecar, copy.parent], check=True)
            lock(copy)
            yield Case(what, command, (*arguments, f"{setting}={copy}"))


def _lock_files(place: Path) -> None:
    for path in (place, *place.rglob("*")):
        if path.is_file():
            path.chmod(0)


def _lock_folder(place: Path) -> None:
    place.chmod(0)


def demo(commands: Commands) -> tuple[str, ...]:
    """Arguments of the page of an evaluation."""
    inputs = commands.inputs
    return commands.report("demo", metrics=inputs / "metrics.json", evaluation=inputs / "evaluation")


def dataset(commands: Commands) -> tuple[str, ...]:
    """Arguments of the report of a data set."""
    inputs = commands.inputs
    given = {"data": inputs / "table", "families": inputs / "grocery.csv"}
    return commands.report("dataset", **given, sensitivity="null", label_check="null")


if __name__ == "__main__":
    main()
