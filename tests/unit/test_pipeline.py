"""A stage of a dvc.yaml depends on code and configuration that decide what it makes, and on nothing else."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from preshape.source_digest import decides_nothing

ROOT = Path(__file__).parents[2]
PIPELINES = [ROOT / "dvc.yaml", *sorted((ROOT / "pipelines").glob("*/dvc.yaml"))]
PLACES = {"preshape": ROOT / "src" / "preshape", "sim": ROOT / "sim", "analysis": ROOT / "analysis"}
LIBRARY = PLACES["preshape"]
PLUMBING = {
    path
    for path in LIBRARY.rglob("*.py")
    if decides_nothing(".".join(("preshape", *path.relative_to(LIBRARY).with_suffix("").parts)))
}


def expanded(stage: dict[str, Any]) -> dict[str, Any]:
    """A stage with every value of its matrix in the place of `${item.key}`."""

    def fill(entries: list[Any], key: str, values: list[str]) -> list[Any]:
        texts = dict.fromkeys(yaml.dump(entry) for entry in entries)
        filled = (text.replace(f"${{item.{key}}}", value) for text in texts for value in values)
        return [yaml.safe_load(text) for text in dict.fromkeys(filled)]

    lists = {name: stage.get(name, []) for name in ("deps", "outs", "metrics")}
    for key, values in stage.get("matrix", {}).items():
        lists = {name: fill(entries, key, values) for name, entries in lists.items()}
    return {**stage, **lists}


STAGES = {
    f"{pipeline.parent.relative_to(ROOT)}:{name}": expanded(stage)
    for pipeline in PIPELINES
    for name, stage in yaml.safe_load(pipeline.read_text(encoding="utf-8"))["stages"].items()
}


def scripts_of(stage: str) -> set[Path]:
    return {ROOT / word for word in re.split(r"[^\w./]", str(STAGES[stage]["cmd"])) if word.endswith(".py")}


def results_of(stage: str) -> set[str]:
    results = (*STAGES[stage]["outs"], *STAGES[stage]["metrics"])
    return {next(iter(result)) if isinstance(result, dict) else result for result in results}


@cache
def imported_files(path: Path) -> frozenset[Path]:
    """The project's files that a file imports itself."""
    files = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            modules = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        else:
            continue
        for module in modules:
            package, *rest = module.split(".")
            if package in PLACES and (file := PLACES[package].joinpath(*rest).with_suffix(".py")).is_file():
                files.add(file)
    return frozenset(files)


def configured_files(stage: str) -> Iterator[Path]:
    """The project's files that the stage's configuration names by `_target_`."""
    for name in STAGES[stage]["deps"]:
        for file in (ROOT / name, *(ROOT / name).rglob("*.yaml")) if name.startswith("conf/") else ():
            text = file.read_text(encoding="utf-8") if file.is_file() else ""
            for package, *rest in (target.split(".") for target in re.findall(r"_target_: ([\w.]+)", text)):
                modules = (PLACES[package].joinpath(*rest[:end]) for end in range(1, len(rest)))
                yield from (file for module in modules if (file := module.with_suffix(".py")).is_file())


def needed_files(stage: str) -> set[Path]:
    needed, new = set(), {*scripts_of(stage), *configured_files(stage)}
    while new:
        needed |= new
        new = {file for path in new for file in imported_files(path)} - needed
    return needed - PLUMBING


@pytest.mark.parametrize("stage", STAGES)
def test_stage_depends_on_the_code_that_it_runs(stage: str) -> None:
    dependencies = [ROOT / name for name in STAGES[stage]["deps"]]
    uncovered = {
        str(path.relative_to(ROOT))
        for path in needed_files(stage)
        if not any(path.is_relative_to(dependency) for dependency in dependencies)
    }
    assert uncovered == set()


@pytest.mark.parametrize("stage", STAGES)
def test_stage_depends_on_no_code_that_it_does_not_run(stage: str) -> None:
    needed = needed_files(stage)
    idle = [
        name
        for name in STAGES[stage]["deps"]
        if name.split("/")[0] in {"src", "sim", "analysis"}
        and not any(path.is_relative_to(ROOT / name) for path in needed)
    ]
    assert idle == []


def inherited_files(path: Path) -> set[Path]:
    """The files of its own folder that a configuration begins with, directly or not."""
    entries = (yaml.safe_load(path.read_text(encoding="utf-8")) or {}).get("defaults", [])
    names = {entry.partition("@")[0] for entry in entries if isinstance(entry, str) and entry != "_self_"}
    files = {path.parent / f"{name}.yaml" for name in names}
    return files.union(*map(inherited_files, files))


@pytest.mark.parametrize("stage", STAGES)
def test_stage_depends_on_what_its_configuration_begins_with(stage: str) -> None:
    given = [ROOT / name for name in STAGES[stage]["deps"] if name.startswith("conf/")]
    files = [path for path in given if path.is_file()]
    missing = {
        str(path.relative_to(ROOT))
        for path in set().union(*map(inherited_files, files))
        if path.name != "base.yaml" and not any(path.is_relative_to(place) for place in given)
    }
    assert missing == set()


@pytest.mark.parametrize("stage", STAGES)
def test_dependencies_exist_or_are_made(stage: str) -> None:
    made = set().union(*map(results_of, STAGES))
    assert [name for name in STAGES[stage]["deps"] if name not in made and not (ROOT / name).exists()] == []
