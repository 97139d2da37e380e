"""Interrupt and kill commands at random moments; start them again, two at a time or elsewhere in the world.

`python tests/hardening/interruptions.py [TEXT ...]` counts what happens; with texts, only commands whose name
holds one of them. What a command ends with must be what it ends with undisturbed.
"""

import hashlib
import json
import logging
import os
import signal
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "fixtures")]

from jobs import JOBS, Job  # noqa: E402
from misuse import become, import_all, run_script  # noqa: E402
from places import make_inputs  # noqa: E402

INTERRUPTED = 130
UNEQUAL = ("runtime_s", "date", "command", "git_revision", "versions", "seconds")
"""What differs between any two runs."""
PAGES = (".html", ".md")
"""They show commands and times."""
MISSING = "missing"
ELSEWHERE = {"TZ": "Asia/Kathmandu", "LC_ALL": "C", "PYTHONUTF8": "0"}

log = logging.getLogger(__name__)


@dataclass
class Count:
    """What happened to a command."""

    interrupted: int = 0
    killed: int = 0
    ended_before: int = 0
    pairs: int = 0
    elsewhere: int = 0
    faults: list[str] = field(default_factory=list)


def main() -> None:
    """Stop every command, and write a table."""
    logging.basicConfig(format="%(message)s", level=logging.INFO, stream=sys.stdout)
    import_all()  # so that they are stopped at their work, and not before it
    texts = sys.argv[1:]
    counts = {}
    with tempfile.TemporaryDirectory(prefix="interruptions") as folder:
        inputs = Path(folder) / "inputs"
        inputs.mkdir()
        make_inputs(inputs)
        for name in JOBS:
            if not texts or any(text in name for text in texts):
                counts[name] = disturb(name, inputs, Path(folder) / name)
    log.info("| command | interrupted | killed | ended before | pairs | elsewhere | wrong |")
    log.info("|---|---:|---:|---:|---:|---:|---|")
    for name, count in counts.items():
        stopped = (count.interrupted, count.killed, count.ended_before)
        numbers = " | ".join(map(str, (*stopped, count.pairs, count.elsewhere)))
        log.info("| %s | %s | %s |", name, numbers, "; ".join(count.faults) or "nothing")
    sys.exit(any(count.faults for count in counts.values()))


def disturb(name: str, inputs: Path, place: Path) -> Count:
    """Stop a command again and again, and compare what it ends with."""
    count, rng = Count(), np.random.default_rng(0)
    undisturbed = JOBS[name](inputs, place / "undisturbed")
    start = time.monotonic()
    status, said = Start(undisturbed, place / "undisturbed").wait()
    longest_s = time.monotonic() - start
    if status != 0:
        count.faults.append(f"status {status} undisturbed")
        log.warning("%s", said)
        return count
    expected = results(undisturbed, place / "undisturbed")
    count.faults += [f"no {name}" for name, found in expected.items() if found == MISSING]
    for kind in (signal.SIGINT, signal.SIGKILL):
        work = place / kind.name
        own = JOBS[name](inputs, work)
        for _ in range(own.rounds):
            running = Start(own, work)
            time.sleep(rng.uniform(0, longest_s))
            _judge(running.stop(kind), kind, count)
            _check_whole(work, count)
        if kind is signal.SIGINT:
            again = [Start(own, work), Start(own, work)]
            count.pairs += 1
        else:
            again = [Start(own, work, ELSEWHERE)]
            count.elsewhere += 1
        _finish(again, own, work, expected, count)
    log.info("%s: %.1f s undisturbed, %s", name, longest_s, count.faults or "nothing wrong")
    return count


class Start:
    """A command that is running.

    Args:
        own: the command.
        work: where it works and where what it says is kept.
        environment: what differs in its environment.
    """

    def __init__(self, own: Job, work: Path, environment: dict[str, str] | None = None) -> None:
        work.mkdir(parents=True, exist_ok=True)
        self._messages = work / f"messages_{time.monotonic_ns()}.txt"
        self.pid = os.fork()
        if self.pid == 0:
            os.setsid()
            signal.signal(signal.SIGINT, signal.default_int_handler)  # in a shell's background it is ignored
            os.environ.update(environment or {})
            time.tzset()
            become(lambda: run_script(own.case), self._messages)

    def wait(self) -> tuple[int, str]:
        """Its status and what it said, when it has ended."""
        status = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        said = self._messages.read_text(errors="replace") if self._messages.exists() else ""
        return status, said

    def stop(self, kind: signal.Signals) -> tuple[int, str]:
        """Send a signal to it alone, as `kill` does."""
        os.kill(self.pid, kind)
        return self.wait()


def _judge(ended: tuple[int, str], kind: signal.Signals, count: Count) -> None:
    status, said = ended
    if status == 0:
        count.ended_before += 1
    elif kind is signal.SIGKILL:
        count.killed += 1
    else:
        count.interrupted += 1
        if status != INTERRUPTED or "Traceback" in said:
            count.faults.append(f"status {status} after an interrupt")
            log.warning("%s", "\n".join(said.splitlines()[-25:]))


def _finish(running: list[Start], own: Job, work: Path, expected: dict[str, str], count: Count) -> None:
    """Wait for the end and compare what is there with what should be."""
    for one in running:
        status, said = one.wait()
        if status != 0:
            count.faults.append(f"status {status} after being started again")
            log.warning("%s", "\n".join(said.splitlines()[-25:]))
    found = results(own, work)
    different = [name for name in expected if found.get(name) != expected[name]]
    if different:
        count.faults.append(f"other results: {', '.join(different)}")
    _check_whole(work, count)


def _check_whole(work: Path, count: Count) -> None:
    """Every file under its own name can be read."""
    for path in work.rglob("*"):
        if path.name.startswith(".") or not path.is_file():
            continue
        try:
            if path.suffix == ".json":
                json.loads(path.read_text(encoding="utf-8"))
            elif path.suffix == ".parquet":
                pq.read_table(path)
            elif path.suffix in (".png", ".webp"):
                Image.open(path).load()
        except Exception as error:
            count.faults.append(f"half-written {path.name} ({error})")


def results(own: Job, work: Path) -> dict[str, str]:
    """Digest of what each file says, but for what differs between any two runs."""
    digests = {}
    places = [work / name for name in own.results]
    below = [path for place in places if place.is_dir() for path in sorted(place.rglob("*"))]
    files = [path for path in (*places, *below) if not path.is_dir() and not path.name.startswith(".")]
    for path in files:
        name = str(path.relative_to(work))
        if not path.is_file():
            digests[name] = MISSING
        elif path.suffix in PAGES:
            digests[name] = "there"
        elif path.suffix == ".parquet":
            frame = pq.read_table(path).to_pandas()
            timings = [column for column in frame if column.endswith("_s")]
            digests[name] = repr(list(frame.drop(columns=timings).itertuples()))
        elif path.suffix in ("", ".json"):
            digests[name] = json.dumps(_lasting(json.loads(path.read_text(encoding="utf-8"))))
        else:
            digests[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return digests


def _lasting(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: _lasting(value) for key, value in content.items() if key not in UNEQUAL}
    return [_lasting(entry) for entry in content] if isinstance(content, list) else content


if __name__ == "__main__":
    main()
