"""The layout that the design promises."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LIBRARY = sorted((ROOT / "src" / "preshape").rglob("*.py"))
SIMULATOR = sorted((ROOT / "sim").rglob("*.py"))
ANALYSIS = sorted((ROOT / "analysis").rglob("*.py"))
ENTRY_POINTS = sorted((ROOT / "src").glob("*.py")) + [
    path
    for folder in ("sim", "analysis", "benchmarks")
    for path in sorted((ROOT / folder).glob("*.py"))
    if "__main__" in path.read_text(encoding="utf-8")
]
FORBIDDEN = [
    (LIBRARY, {"sapien", "sim", "analysis"}),
    (SIMULATOR, {"analysis"}),
    (ANALYSIS, {"sim", "sapien"}),
]


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def imported_packages(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module.split(".")[0]


def is_import(node: ast.AST) -> bool:
    return isinstance(node, ast.Import | ast.ImportFrom)


@pytest.mark.parametrize(
    ("path", "forbidden"),
    [pytest.param(path, forbidden, id=name(path)) for paths, forbidden in FORBIDDEN for path in paths],
)
def test_imports_go_one_way(path: Path, forbidden: set[str]) -> None:
    assert not forbidden & set(imported_packages(path))


@pytest.mark.parametrize("path", ENTRY_POINTS, ids=name)
def test_entry_points_are_short(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 40


@pytest.mark.parametrize("path", [path for path in ENTRY_POINTS if path.parts[-2] != "benchmarks"], ids=name)
def test_an_interrupt_is_understood_from_the_first_import_on(path: Path) -> None:
    imports = (node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if is_import(node))
    assert ast.unparse(next(imports)) == "import preshape.command_line.startup"


@pytest.mark.parametrize("path", LIBRARY + SIMULATOR + ANALYSIS, ids=name)
def test_files_are_named_after_one_concept(path: Path) -> None:
    assert path.stem not in {"utils", "util", "helpers", "misc", "common"}
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 250


@pytest.mark.parametrize("folder", ["src", "sim", "analysis", "benchmarks"])
def test_entry_points_shadow_nothing(folder: str) -> None:
    # Python puts the folder of a script first on its path, so a sim/queue.py would hide the standard queue.
    packages = {path.name for path in (ROOT / "src" / "preshape").iterdir() if path.is_dir()}
    modules = {path.stem for path in (ROOT / folder).glob("*") if path.suffix == ".py" or path.is_dir()}
    assert not modules & set(sys.stdlib_module_names)
    assert folder != "src" or not modules & packages
