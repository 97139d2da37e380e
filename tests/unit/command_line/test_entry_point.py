"""Commands start anywhere, refuse bad input in one message, and keep the traceback of defects."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = """
import os
import signal
import sys
from pathlib import Path

import hydra
from omegaconf import DictConfig

import preshape.command_line.entry_point

preshape.command_line.entry_point.project_root = lambda: Path(__file__).parent


class Drawing:
    def __del__(self) -> None:
        os.kill(os.getpid(), signal.SIGSEGV)


@preshape.command_line.entry_point.entry_point("command")
def main(cfg: DictConfig) -> None:
    try:
        if cfg.interrupt:
            drawing = Drawing()  # as a simulator's scene, which must not go while it is drawn
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        if cfg.interrupt == "swallowed":
            sys.exit(1)
        raise
    hydra.utils.instantiate(cfg.part)
    print("works in", os.getcwd(), "with", 1 / cfg.divisor)


main()
"""
PARTS = """
from preshape.errors import InputError


class Part:
    def __init__(self, size: int) -> None:
        if size > 5:
            raise InputError("The part is too large", where=f"part.size={size}", fix="make it smaller")
"""
CONFIG = """
defaults: [base, part: small, _self_]
divisor: 2
interrupt: null
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("project")
    base = Path(__file__).parents[3] / "conf" / "base.yaml"
    (root / "conf" / "part").mkdir(parents=True)
    (root / "conf" / "base.yaml").write_bytes(base.read_bytes())
    (root / "conf" / "command.yaml").write_text(CONFIG)
    (root / "conf" / "part" / "small.yaml").write_text("_target_: parts.Part\nsize: 1\n")
    (root / "command.py").write_text(COMMAND)
    (root / "parts.py").write_text(PARTS)
    return root


@pytest.fixture
def run(project: Path, tmp_path: Path):
    def run(*overrides: str) -> subprocess.CompletedProcess[str]:
        environment = {name: value for name, value in os.environ.items() if name != "HYDRA_FULL_ERROR"}
        environment["PYTHONPATH"] = str(project)
        command = [sys.executable, str(project / "command.py"), *overrides]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)

    return run


def test_command_stays_where_it_was_started_and_writes_under_outputs(run, project, tmp_path) -> None:
    done = run()
    assert done.returncode == 0, done.stderr
    assert f"works in {tmp_path} with 0.5" in done.stdout
    assert list(tmp_path.iterdir()) == []
    assert list((project / "outputs" / "command").glob("*/.hydra/config.yaml"))


def test_outputs_can_lie_beside_the_user(run, tmp_path) -> None:
    assert run("paths.outputs=here").returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["here"]


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["part.size=9"], "The part is too large"),
        (["--multirun", "part.size=1,9"], "The part is too large"),
        (["part=huge"], "Could not find 'part/huge'"),
        (["--multirun", "part=huge,small"], "Could not find 'part/huge'"),
        (["part.colour=red"], "Could not override 'part.colour'"),
        (["divisor=[1"], "'divisor=[1' cannot be read"),
        (["divisor=???"], "divisor=..."),
        (["part.size=${no.such}"], "Interpolation key 'no.such' not found"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_misuse_ends_with_one_message_and_status_2(run, overrides: list[str], message: str) -> None:
    refused = run(*overrides)
    assert refused.returncode == 2, refused.stderr
    assert message in refused.stderr
    assert "Traceback" not in refused.stderr
    assert "provider=" not in refused.stderr
    assert len(refused.stderr.splitlines()) < 12


@pytest.mark.parametrize("sweep", [[], ["--multirun"]])
def test_outputs_that_cannot_be_written_are_refused(run, tmp_path, sweep: list[str]) -> None:
    (tmp_path / "file").touch()
    refused = run(*sweep, f"paths.outputs={tmp_path / 'file' / 'outputs'}")
    assert refused.returncode == 2, refused.stderr
    assert "paths.outputs=DIR" in refused.stderr
    assert "Traceback" not in refused.stderr


def test_misuse_in_a_parallel_sweep_ends_with_status_2(run) -> None:
    refused = run("--multirun", "hydra/launcher=joblib", "hydra.launcher.n_jobs=2", "part.size=1,9")
    assert refused.returncode == 2, refused.stderr
    assert "The part is too large" in refused.stderr


def test_defects_keep_their_traceback(run) -> None:
    failed = run("divisor=0")
    assert failed.returncode == 1
    assert "Traceback" in failed.stderr
    assert "ZeroDivisionError" in failed.stderr


@pytest.mark.parametrize("how", ["plain", "swallowed"])
def test_interrupt_ends_with_status_130(run, how: str) -> None:
    interrupted = run(f"interrupt={how}")
    assert interrupted.returncode == 130
    assert "Traceback" not in interrupted.stderr
