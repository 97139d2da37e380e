"""Wrong uses of every command."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from places import DAMAGES, DAMAGES_OF_MORE, damaged
from report_inputs import CORNELL_FILES, Input, Reports
from wrong_values import WRONG_VALUES

from preshape.paths import project_root

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
        if not (work / "folds").exists():  # detections are written beside the weights
            shutil.copytree(inputs / "folds", work / "folds")
        self.places = places = (f"paths.outputs={work / 'outputs'}", f"paths.cache={work / 'cache'}")
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
                *("tracking=none", f"dataset.root={inputs / 'cornell'}", f"runs={work / 'folds'}"),
                *("splits=[unseen]", "detector.counts=[1]", "detector.planner.starts.count=2"),
                *("detector.grid.step_px=60", "detector.grid.angles=2", f"output={work / 'cornell.json'}"),
            ),
            "src/export.py": (*places, "model=config_cnn", f"weights={inputs / 'config_cnn.safetensors'}"),
            "src/fit_prior.py": (*places, *boxes, "prior.fit.components=1"),
            "src/render.py": (*places, *boxes),
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
            "sim/write_cornell.py": (
                *places,
                *(f"output={work / 'written'}", "maker.workers=1", f"maker.table={inputs / 'rectangles'}"),
            ),
            "analysis/report.py": (*places,),
        }

    def report(self, name: str, **settings: object) -> tuple[str, ...]:
        """Arguments of a report that writes into the folder of the work."""
        written = {
            "benchmarks": ("page",),
            "collection": ("output",),
            "cornell": ("output", "page"),
            "dataset": ("output", "card", "page"),
            "curves": ("output",),
            "first_pass": ("output",),
            "gripper": ("output", "page"),
            "learning": ("output", "page", "record"),
            "objects": ("page",),
            "paper": ("output",),
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
    """Every file that a command reads, as it should be, and in all ways in which it can be wrong."""
    whole = dict.fromkeys(
        (own.command, *own.arguments, own.argument(own.good)) for own in inputs_of(commands)
    )
    for command, *arguments in whole:
        yield Case("nothing wrong", command, tuple(arguments), status=0)
    for number, own in enumerate(inputs_of(commands)):
        for how in DAMAGES if own.damaged is None else DAMAGES_OF_MORE:
            place = commands.work / "damaged" / f"{number}_{how.replace(' ', '_')}"
            path = damaged(own.good, how, place, commands.work / "executed", own.damaged)
            arguments = (*own.arguments, own.argument(path))
            yield Case(f"file: {how}", own.command, arguments, may_succeed=own.may_do)


def inputs_of(commands: Commands) -> Iterator[Input]:
    """Everything that is read."""
    inputs, usual = commands.inputs, commands.usual

    def of(command: str, *more: str) -> tuple[str, tuple[str, ...]]:
        return command, (*usual[command], *more)

    plan, table = of("src/plan.py"), inputs / "table"
    for setting, name in (
        *(("rgb_file", "view/rgb.png"), ("depth_file", "view/depth.png"), ("depth_file", "depth.npy")),
        *(("camera_file", "view/camera.json"), ("weights", "palm_points.safetensors")),
    ):
        yield Input(*plan, setting, inputs / name)
    for name in ("prior.json", "prior.safetensors"):
        yield Input(*of("src/plan.py", "planner.prior.weight=1"), "planner.prior.file", inputs / name)
    yield Input(*of("src/export.py"), "weights", inputs / "config_cnn.safetensors")
    yield Input(*of("sim/evaluate.py"), "weights", inputs / "palm_points.safetensors")
    for command in ("src/train.py", "src/fit_prior.py", "src/render.py"):
        yield Input(*of(command), "dataset.data.folder", table)
    shipped = project_root() / "data" / "allegro_grocery"
    for command in ("sim/replay.py", "sim/sensitivity.py", "sim/last_frames.py"):
        yield Input(*of(command), "table", shipped)
    yield Input(*of("sim/write_cornell.py"), "maker.table", inputs / "rectangles")
    for file in CORNELL_FILES:
        yield Input(*of("src/detect.py"), "dataset.root", inputs / "cornell", file)
    for file in ("model.safetensors", "model.safetensors.json", "metrics.json", "predictions.parquet"):
        yield Input(*of("src/detect.py"), "runs", commands.work / "folds", f"unseen_fold0/{file}")
    for command in ("sim/collect.py", "sim/contact_sheet.py"):
        yield Input(*of(command, "objects=mesh_folder"), "objects.root", inputs / "meshes")
    yield from Reports(commands.report, inputs)
