"""Use every command wrongly and count what happens: `python tests/hardening/misuse.py [TEXT ...]`.

Only cases whose command line holds one of the texts are run, if texts are given. The libraries are imported
once, and every case runs in a copy of that process, so that it takes a second instead of ten.
"""

import hashlib
import logging
import os
import re
import runpy
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "fixtures")]

from cases import REFUSED, Case, Commands, file_cases, syntax_cases, value_cases  # noqa: E402
from places import make_inputs  # noqa: E402

LIBRARIES = (
    *("torch", "lightning", "hydra", "mlflow", "sapien", "open3d", "pinocchio", "sklearn", "scipy", "pandas"),
    *("matplotlib.pyplot", "trimesh", "coal", "ompl", "toppra", "onnx", "torchmetrics"),
)
MODULES = (
    *(
        "preshape.command_line.entry_point",
        "preshape.training_job",
        "preshape.configured_planner",
        "preshape.models.onnx_export",
    ),
    *("preshape.planning.prior_fitting", "preshape.cornell.protocols", "sim.collection", "sim.label_flips"),
    *("sim.collected_tables", "sim.configured_evaluation", "sim.improvement", "sim.repetition"),
    *("sim.frame_sheets", "sim.object_portraits", "sim.simulated_cornell", "analysis.dataset.report"),
    *(
        "analysis.pages.demo_page",
        "analysis.planning.report",
        "analysis.learning.report",
        "analysis.learning.curve_tables",
    ),
    *("analysis.cornell.report", "analysis.pages.paper_report", "analysis.planning.gripper_report"),
)
"""What the commands import, so that they are at their work soon."""
FEW = 10
"""For more cases it is worth while to import all that before."""
LIMIT_S = 180.0
UNFINISHED = re.compile(r"^\..+\.\d+-[0-9a-f]{8}(\.\w+)?$")
"""Names of the temporary files of `preshape.files`."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Outcome:
    """What happened in a case.

    Args:
        case: the case.
        status: exit status; None if it had to be stopped.
        said: what it wrote.
        faults: what is not as it should be.
        seconds: how long it took.
    """

    case: Case
    status: int | None
    said: str
    faults: tuple[str, ...]
    seconds: float


def main() -> None:
    """Run all cases and write a table of the kinds."""
    logging.basicConfig(format="%(message)s", level=logging.INFO, stream=sys.stdout)
    texts = sys.argv[1:]
    with tempfile.TemporaryDirectory(prefix="misuse") as folder:
        inputs, work = Path(folder) / "inputs", Path(folder) / "work"
        for place in (inputs, work):
            place.mkdir()
        make_inputs(inputs)
        commands = Commands(inputs, work)
        cases = [*syntax_cases(commands), *value_cases(commands), *file_cases(commands)]
        chosen = [case for case in cases if not texts or any(text in str(case) for text in texts)]
        if len(chosen) > FEW:
            import_all()
        outcomes = [run_case(case, inputs, work) for case in chosen]
    log.info("%s", table(outcomes))
    sys.exit(any(outcome.faults for outcome in outcomes))


def import_all() -> None:
    """Import what the commands do."""
    for name in (*LIBRARIES, *MODULES):
        import_module(name)


def run_case(case: Case, inputs: Path, work: Path, prepare: Callable[[], None] = lambda: None) -> Outcome:
    """Run a case and look at what it said and left behind.

    Args:
        case: the case.
        inputs: folder that must not change.
        work: folder that is written to.
        prepare: done in the process of the command before it begins.
    """

    def command() -> None:
        prepare()
        run_script(case)

    before, start = digest(inputs), time.monotonic()
    status, said = run_here(command, work.parent / "messages.txt", LIMIT_S)
    faults = [*faults_of(case, status, said)]
    if digest(inputs) != before:
        faults.append("input changed")
    if any(UNFINISHED.match(path.name) for path in work.rglob("*")):
        faults.append("half-written file")
    if (work / "executed").exists():
        faults.append("executed")
        (work / "executed").unlink()
    for name in ("outputs", "report", "written"):
        shutil.rmtree(work / name, ignore_errors=True)
    outcome = Outcome(case, status, said, tuple(faults), time.monotonic() - start)
    level = logging.WARNING if faults else logging.INFO
    shown = f"{case.command} ... {case.arguments[-1]}"
    log.log(level, "%-6s %5.1f s  %s: %s", ", ".join(faults) or "fine", outcome.seconds, case.kind, shown)
    if faults:
        log.warning("%s", "\n".join(f"    | {line}" for line in said.splitlines()[-14:]))
    return outcome


def faults_of(case: Case, status: int | None, said: str) -> list[str]:
    """What is wrong with the way in which a command ended."""
    faults = []
    if status is None:
        faults.append("endless")
    elif status != case.status and not (case.may_succeed and status == 0):
        faults.append(f"status {status}")
    if "Traceback" in said:
        faults.append("traceback")
    elif status == REFUSED and "ERROR:" not in said and "usage:" not in said and "error:" not in said:
        faults.append("no message")
    return faults


def run_script(case: Case) -> None:
    """The script, as Python runs it."""
    script = str(ROOT / case.command)
    sys.argv = [script, *case.arguments]
    sys.path.insert(0, str(Path(script).parent))
    runpy.run_path(script, run_name="__main__")


def run_here(action: Callable[[], None], messages: Path, limit_s: float) -> tuple[int | None, str]:
    """Do something in a copy of this process; returns its status (None if stopped) and what it said."""
    pid = os.fork()
    if pid == 0:
        os.setsid()
        become(action, messages)
    end = time.monotonic() + limit_s
    status = None
    while status is None and time.monotonic() < end:
        found, ended = os.waitpid(pid, os.WNOHANG)
        status = os.waitstatus_to_exitcode(ended) if found else None
        time.sleep(0.02)
    if status is None:
        os.killpg(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
    return status, messages.read_text(errors="replace")


def become(action: Callable[[], None], messages: Path) -> None:
    """End this process as Python ends one that does just this."""
    status = 1
    try:
        with messages.open("wb") as file:
            for stream in (1, 2):
                os.dup2(file.fileno(), stream)
        sys.stdout = os.fdopen(1, "w", buffering=1, closefd=False)
        sys.stderr = os.fdopen(2, "w", buffering=1, closefd=False)
        logging.getLogger().handlers.clear()
        action()
        status = 0
    except SystemExit as end:
        if isinstance(end.code, str):
            sys.stderr.write(f"{end.code}\n")
        status = 0 if end.code is None else end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # Python ends itself with the signal then
        traceback.print_exc()
        status = 130
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def digest(folder: Path) -> str:
    """Digest of all files of a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return hashlib.sha256(
        b"".join(str(path).encode() + hashlib.sha256(path.read_bytes()).digest() for path in files)
    ).hexdigest()


def table(outcomes: Sequence[Outcome]) -> str:
    """A Markdown table with one row for each kind."""
    lines = ["", "| tried | times | refused with a message | something else |", "|---|---:|---:|---|"]
    for kind in dict.fromkeys(outcome.case.kind for outcome in outcomes):
        own = [outcome for outcome in outcomes if outcome.case.kind == kind]
        fine = sum(not outcome.faults for outcome in own)
        faults = Counter(fault for outcome in own for fault in outcome.faults)
        other = ", ".join(f"{count} {fault}" for fault, count in faults.items())
        lines.append(f"| {kind} | {len(own)} | {fine} | {other} |")
    fine = sum(not outcome.faults for outcome in outcomes)
    return "\n".join([*lines, f"| all | {len(outcomes)} | {fine} | |"])


if __name__ == "__main__":
    main()
