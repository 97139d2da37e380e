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
        results: the files and folders that it ends with, below the folder of the work.
        rounds: so often it is stopped with each signal.
    """

    name: str
    case: Case
    results: tuple[str, ...]
    rounds: int


JOBS: dict[str, Callable[[Path, Path], Job]] = {}


def job(name: str, rounds: int = 2) -> Callable[[Callable[[Commands], tuple[Case, tuple[str, ...]]]], None]:
    """Name a function that makes a command and what it ends with."""

    def keep(make: Callable[[Commands], tuple[Case, tuple[str, ...]]]) -> None:
        JOBS[name] = lambda inputs, work: Job(name, *make(Commands(inputs, work)), rounds)

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


@job("detect")
def _detect(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    return Case("", "src/detect.py", commands.usual["src/detect.py"]), ("cornell.json", "folds")


@job("render")
def _render(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    shipped = ("dataset.data.trials=60", "dataset.data.views.maker.workers=1")
    case = Case("", "src/render.py", (*commands.places, *shipped))
    return case, ("outputs/render/allegro_grocery.json",)


@job("collect", rounds=1)
def _collect(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"collect.output={commands.work / 'table'}"
    case = Case("", "sim/collect.py", (*commands.usual["sim/collect.py"], "collect.trials=3", output))
    return case, ("table/scenes.parquet", "table/trials.parquet")


@job("evaluate", rounds=1)
def _evaluate(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    case = Case("", "sim/evaluate.py", commands.usual["sim/evaluate.py"])
    folder = "outputs/evaluate/palm_points"
    return case, tuple(f"{folder}/{name}" for name in ("evaluation.json", "scenes.parquet", "trials.parquet"))


@job("improve", rounds=1)
def _improve(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    little = (
        *("rounds=2", "acquired_scenes=1", "evaluate.poses_per_object=1", "evaluate.workers=1"),
        *("laboratory.scenes.only=[detergent]", "dataset.data.trials=60", "split=scenes", "model.members=2"),
        *("learning.settings.iterations=4", "learning.batch_size=16", "trainer.batches_per_epoch=2"),
        *("~planner@planners.heuristic", "~planner@planners.max_eval"),
        "dataset.data.views.maker.workers=1",
    )
    case = Case("", "sim/improve.py", (*commands.places, *little))
    return case, ("outputs/improve/planner_optimum/improvement.json",)


@job("replay")
def _replay(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"output={commands.work / 'films'}"
    return Case("", "sim/replay.py", (*commands.usual["sim/replay.py"], output)), ("films/43.webp",)


@job("sensitivity")
def _sensitivity(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    return Case("", "sim/sensitivity.py", commands.usual["sim/sensitivity.py"]), ("sensitivity.json",)


@job("last_frames")
def _last_frames(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    output = f"output={commands.work / 'frames'}"
    return Case("", "sim/last_frames.py", (*commands.usual["sim/last_frames.py"], output)), ("frames",)


@job("contact_sheet")
def _contact_sheet(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    own = ("objects=mesh_folder", f"objects.root={commands.inputs / 'meshes'}")
    output = f"output={commands.work / 'sheet.webp'}"
    return Case("", "sim/contact_sheet.py", (*commands.places, *own, output)), ("sheet.webp",)


@job("write_cornell")
def _write_cornell(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    return Case("", "sim/write_cornell.py", commands.usual["sim/write_cornell.py"]), ("written",)


@job("report_dataset")
def _dataset(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    inputs = commands.inputs
    given = {"data": inputs / "table", "families": inputs / "grocery.csv"}
    arguments = commands.report("dataset", **given, sensitivity="null", label_check="null")
    return Case("", "analysis/report.py", arguments), ("report/output",)


@job("report_demo")
def _demo(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    inputs = commands.inputs
    given = {"metrics": inputs / "metrics.json", "evaluation": inputs / "evaluation"}
    page = f"report.output={commands.work / 'report.html'}"
    arguments = (*commands.report("demo", **given, max_scenes=1), page)
    return Case("", "analysis/report.py", arguments), ("report.html",)


@job("report_planning")
def _planning(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    seen = f"report.conditions.seen={commands.inputs / 'evaluation'}"
    return Case("", "analysis/report.py", (*commands.report("planning"), seen)), ("report/output",)


@job("report_learning")
def _learning(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    arguments = commands.report("learning", runs=commands.inputs / "sweep")
    return Case("", "analysis/report.py", arguments), ("report/output", "report/record")


@job("report_curves")
def _curves(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    inputs = commands.inputs
    given = {"run": inputs / "sweep/palm_points/unseen_fold0", "evaluation": inputs / "evaluation"}
    return Case("", "analysis/report.py", commands.report("curves", **given)), ("report/output",)


@job("report_cornell")
def _cornell(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    given = {"root": commands.inputs / "cornell", "runs": "null", "shown": 1, "compared": 1}
    nowhere = f"report.results={commands.work / 'no_results.json'}"
    arguments = (*commands.report("cornell", **given), nowhere)
    return Case("", "analysis/report.py", arguments), ("report/output",)


@job("report_paper")
def _paper(commands: Commands) -> tuple[Case, tuple[str, ...]]:
    page = f"report.output={commands.work / 'report.html'}"
    return Case("", "analysis/report.py", (*commands.report("paper"), page)), ("report.html",)
