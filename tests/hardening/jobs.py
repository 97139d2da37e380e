"""Commands that can be started again, with the files that they end with."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from cases import Case, Commands


@dataclass(frozen=True)
class Job:
    """A command that can be started again.

    Args:
        name: for the table.
        case: the command.
        results: the files that it ends with, below the folder of the work.
    """

    name: str
    case: Case
    results: tuple[str, ...]


JOBS: dict[str, Callable[[Path, Path], Job]] = {}


def job(name: str) -> Callable[[Callable[[Commands], tuple[Case, tuple[str, ...]]]], None]:
    """Name a function that makes a command and the files that it ends with."""

    def keep(make: Callable[[Commands], tuple[Case, tuple[str, ...]]]) -> None:
        JOBS[name] = lambda inputs, work: Job(name, *make(Commands(inputs, work)))

    return keep


@job("train")
def _train(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    longer = ("learning.settings.iterations=60", "trainer.batches_per_epoch=6")
    folder = "outputs/train/palm_points"
    files = (
        "model.safetensors",
        "model.safetensors.json",
        "metrics.json",
        "curves.json",
        "predictions.parquet",
    )
    case = Case("", "src/train.py", (*commands.usual["src/train.py"], *longer))
    return case, tuple(f"{folder}/{name}" for name in files)


@job("plan")
def _plan(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"output={commands.work / 'plan'}"
    case = Case("", "src/plan.py", (*commands.usual["src/plan.py"], output))
    return case, ("plan/grasps.json", "plan/grasps.png")


@job("fit_prior")
def _fit_prior(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"output={commands.work / 'prior.json'}"
    return Case("", "src/fit_prior.py", (*commands.usual["src/fit_prior.py"], output)), ("prior.json",)


@job("export")
def _export(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"output={commands.work / 'network.onnx'}"
    return Case("", "src/export.py", (*commands.usual["src/export.py"], output)), ("network.onnx",)


@job("report of a data set")
def _dataset(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    inputs = commands.inputs
    given = {"data": inputs / "table", "families": inputs / "grocery.csv"}
    arguments = commands.report("dataset", **given, sensitivity="null", label_check="null")
    return Case("", "analysis/report.py", arguments), ("report/output",)


@job("collect")
def _collect(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"collect.output={commands.work / 'table'}"
    case = Case("", "sim/collect.py", (*commands.usual["sim/collect.py"], "collect.trials=3", output))
    return case, ("table/scenes.parquet", "table/trials.parquet")
