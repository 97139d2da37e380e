"""Names for derived files that change whenever the code that makes them changes."""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from preshape.paths import project_root

FOLDERS = {"preshape": "src", "sim": "."}
"""Where the project's packages lie."""
DECIDES_NOTHING = (
    *("preshape.command_line", "preshape.sweeps", "preshape.tracking", "preshape.training_job"),
    *("preshape.errors", "preshape.files", "preshape.paths", "preshape.progress", "preshape.provenance"),
)
"""Packages and modules by which a run is started, told and kept; what comes out does not depend on them."""


@cache
def source_digest(module: str) -> str:
    """Hash of a module's code and of all code of the project that it imports, directly or not.

    Comments, docstrings and layout do not count, and neither do imported modules that decide nothing.

    Args:
        module: full name, such as `preshape.perception.object_view`.
    """
    codes: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = _source(name)
        if name not in codes and path is not None:
            tree = ast.parse(path.read_bytes())
            waiting += (found for found in _imports(tree) if not decides_nothing(found))
            codes[name] = _code(tree)
    return hashlib.sha256(repr(sorted(codes.items())).encode()).hexdigest()


def decides_nothing(module: str) -> bool:
    """Whether nothing that comes out of a run depends on a module: see `DECIDES_NOTHING`."""
    return any(f"{module}.".startswith(f"{own}.") for own in DECIDES_NOTHING)


def _source(module: str) -> Path | None:
    """File of a module; None for what is not a module of the project."""
    package, *rest = module.split(".")
    if package not in FOLDERS:
        return None
    stem = project_root() / FOLDERS[package] / Path(package, *rest)
    candidates = (stem.with_suffix(".py"), stem / "__init__.py")
    return next((path for path in candidates if path.is_file()), None)


def _imports(tree: ast.Module) -> Iterator[str]:
    """Names that may be modules."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _code(tree: ast.Module) -> str:
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [statement for statement in node.body if not _is_text(statement)]
    return ast.dump(tree)


def _is_text(statement: ast.stmt) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )
