"""Wrong uses of every command."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from places import DAMAGES, damaged
from wrong_values import WRONG_VALUES

REFUSED = 2


@dataclass(frozen=True)
class Case:
    """One wrong use.

    Args:
        kind: what is wrong, as a row of the table.
        command: the script.
        arguments: the command line.
        status: the exit status that is wanted.
        may_succeed: whether the command may as well come to its end.
    """

    kind: str
    command: str
    arguments: tuple[str, ...]
    status: int = REFUSED
    may_succeed: bool = False

    def __str__(self) -> str:
        return " ".join((self.command, *self.arguments))


class Commands:
    """The commands with arguments that keep them small and away from the project's own files.

    Args:
        inputs: folder of `make_inputs`.
        work: where everything is written.
    """

    def __init__(self, inputs: Path, work: Path) -> None:
        self.inputs, self.work = inputs, work
        places = (f"paths.outputs={work / 'outputs'}", f"paths.cache={work / 'cache'}")
        boxes = (
            "dataset.data.views.renderer={_target_:synthetic_scenes.BoxRenderer}",
            "dataset.data.views.maker=null",
            f"dataset.data.folder={inputs / 'table'}",
            "dataset.data.hold_out.validation_fraction=0.25",
        )
        weights = f"weights={inputs / 'palm_points.safetensors'}"
        self.usual: dict[str, tuple[str, ...]] = {
            "src/train.py": (
                *places,
                *boxes,
                *("tracking=none", "learning.settings.iterations=4", "learning.batch_size=8"),
                "trainer.batches_per_epoch=2",
            ),
            "src/plan.py": (*places, f"view={inputs / 'view'}", weights, "planner.method.max_iterations=1"),
            "src/detect.py": (
                *places,
                *("tracking=none", f"dataset.root={inputs / 'cornell'}", f"runs={work / 'runs'}"),
                f"output={work / 'cornell.json'}",
            ),
            "src/export.py": (*places, "model=config_cnn", f"weights={inputs / 'config_cnn.safetensors'}"),
            "src/fit_prior.py": (*places, *boxes, "prior.fit.components=1"),
            "sim/collect.py": (
                *places,
                *("collect.trials=1", "collect.workers=1", "collect.block=1"),
            ),
            "sim/evaluate.py": (*places, weights, "tracking=none", "evaluate.scenes=1", "evaluate.workers=1"),
            "sim/improve.py": (
                *places,
                *("rounds=1", "evaluate.scenes=1", "evaluate.poses_per_object=null", "evaluate.workers=1"),
                *boxes,
            ),
            "sim/replay.py": (*places, "trials=[43]"),
            "sim/sensitivity.py": (
                *places,
                *("trials=1", "workers=1", "only=[unchanged]", f"output={work / 'sensitivity.json'}"),
            ),
            "sim/crash_test.py": (*places, "kills=1", f"output={work / 'crash_test.json'}"),
            "sim/contact_sheet.py": (*places,),
            "sim/last_frames.py": (*places, "trials=1", "workers=1", f"result={work / 'label_check.json'}"),
            "sim/write_cornell.py": (*places, f"output={work / 'written'}", "maker.workers=1"),
            "analysis/report.py": (*places,),
        }

    def report(self, name: str, **settings: object) -> tuple[str, ...]:
        """Arguments of a report that writes into the folder of the work."""
        written = {
            "benchmarks": ("page",),
            "collection": ("output",),
            "cornell": ("results",),
            "dataset": ("output", "card", "page"),
            "first_pass": ("output",),
            "gripper": ("output",),
            "learning": ("output", "page"),
            "objects": ("page",),
            "planning": ("output", "page"),
            "demo": ("output",),
        }[name]
        return (
            *self.usual["analysis/report.py"],
            f"report={name}",
            *(f"report.{key}={self.work / 'report' / key}" for key in written),
            *(f"report.{key}={value}" for key, value in settings.items()),
        )


def syntax_cases(commands: Commands) -> Iterator[Case]:
    """What no command knows."""
    for command, usual in commands.usual.items():
        yield Case("unknown option", command, (*usual, "--nonsense"))
        yield Case("unknown setting", command, (*usual, "no.such.setting=1"))
        yield Case("unknown choice", command, (*usual, "robot=no_such_robot"))
        yield Case("broken syntax", command, (*usual, "seed=[1"))
    yield Case("unknown choice", "analysis/report.py", ("report=no_such_report",))
    yield Case("unknown choice", "src/train.py", (*commands.usual["src/train.py"], "experiment=no_such"))


def value_cases(commands: Commands) -> Iterator[Case]:
    """Settings with values that cannot be."""
    for command, values in WRONG_VALUES.items():
        for value in values:
            yield Case("wrong value", command, (*commands.usual[command], value))


def file_cases(commands: Commands) -> Iterator[Case]:
    """Every file that a command reads, in all ways in which it can be wrong."""
    for number, (command, arguments, setting, good) in enumerate(_inputs(commands)):
        for how in DAMAGES:
            place = commands.work / "damaged" / f"{number}_{how.replace(' ', '_')}"
            path = damaged(good, how, place, commands.work / "executed")
            yield Case(f"file: {how}", command, (*arguments, f"{setting}={path}"))


def _inputs(commands: Commands) -> Iterator[tuple[str, tuple[str, ...], str, Path]]:
    """Command, arguments, setting and good file of everything that is read."""
    inputs, usual = commands.inputs, commands.usual
    plan, table = usual["src/plan.py"], inputs / "table"
    yield "src/plan.py", plan, "rgb_file", inputs / "view" / "rgb.png"
    yield "src/plan.py", plan, "depth_file", inputs / "view" / "depth.png"
    yield "src/plan.py", plan, "depth_file", inputs / "depth.npy"
    yield "src/plan.py", plan, "camera_file", inputs / "view" / "camera.json"
    yield "src/plan.py", plan, "weights", inputs / "palm_points.safetensors"
    for prior in ("prior.json", "prior.safetensors"):
        yield "src/plan.py", (*plan, "planner.prior.weight=1"), "planner.prior.file", inputs / prior
    yield "src/export.py", usual["src/export.py"], "weights", inputs / "config_cnn.safetensors"
    yield "sim/evaluate.py", usual["sim/evaluate.py"], "weights", inputs / "palm_points.safetensors"
    for command in ("src/train.py", "src/fit_prior.py"):
        yield command, usual[command], "dataset.data.folder", table
    for command in ("sim/replay.py", "sim/sensitivity.py", "sim/last_frames.py"):
        yield command, usual[command], "table", table
    yield "sim/write_cornell.py", usual["sim/write_cornell.py"], "maker.table", table
    yield "src/detect.py", usual["src/detect.py"], "dataset.root", inputs / "cornell"
    yield (
        "sim/collect.py",
        (*usual["sim/collect.py"], "objects=mesh_folder"),
        "objects.root",
        inputs / "meshes",
    )
    sheet = usual["sim/contact_sheet.py"]
    yield "sim/contact_sheet.py", (*sheet, "objects=mesh_folder"), "objects.root", inputs / "meshes"
    evaluation, metrics = inputs / "evaluation", inputs / "metrics.json"
    demo = commands.report("demo", metrics=metrics, evaluation=evaluation)
    yield "analysis/report.py", demo, "report.evaluation", evaluation
    yield "analysis/report.py", demo, "report.metrics", metrics
    data = commands.report(
        "dataset", data=table, families=inputs / "grocery.csv", sensitivity="null", label_check="null"
    )
    yield "analysis/report.py", data, "report.data", table
    yield "analysis/report.py", data, "report.families", inputs / "grocery.csv"
    for key in ("sensitivity", "label_check"):
        yield "analysis/report.py", data, f"report.{key}", _result(key)
    for key in ("dataset", "crash_test", "sensitivity", "label_check"):
        yield (
            "analysis/report.py",
            commands.report("collection", effort="null"),
            f"report.{key}",
            _result(key),
        )
    yield "analysis/report.py", commands.report("benchmarks"), "report.results", _result("benchmarks")
    first = commands.report("first_pass", data=table, metrics=metrics, evaluation=evaluation)
    yield "analysis/report.py", first, "report.evaluation", evaluation
    yield "analysis/report.py", commands.report("objects", data=table), "report.data", table
    yield (
        "analysis/report.py",
        commands.report("cornell", shown=1, compared=1),
        "report.root",
        inputs / "cornell",
    )


def _result(name: str) -> Path:
    return Path(__file__).parents[2] / "results" / f"{name}.json"
