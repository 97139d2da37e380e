"""The digest of code: follows what the code does and what it imports, and nothing else."""

from pathlib import Path

import pytest

from preshape import source_digest as module

SOURCES = Path(module.__file__).parent
FILES = {
    "sim/pictures.py": (
        '"""Pictures."""\nfrom preshape.lens import focus\n\n\ndef draw():\n    return focus(1)\n'
    ),
    "src/preshape/lens.py": (
        "import numpy\nimport preshape.files\nimport preshape.glass\nimport preshape.tracking.store\n\n\n"
        "def focus(x):\n    return x + 1\n"
    ),
    "src/preshape/glass.py": "INDEX = 1.5\n",
    "src/preshape/other.py": "X = 1\n",
    "src/preshape/files.py": "MODE = 1\n",
    "src/preshape/tracking/store.py": "RUNS = 1\n",
}


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(module, "project_root", lambda: tmp_path)
    return tmp_path


def digest() -> str:
    module.source_digest.cache_clear()
    return module.source_digest("sim.pictures")


@pytest.mark.parametrize(
    ("name", "old", "new", "same"),
    [
        ("sim/pictures.py", "focus(1)", "focus(2)", False),
        ("src/preshape/lens.py", "x + 1", "x + 2", False),
        ("src/preshape/glass.py", "1.5", "1.6", False),
        ("src/preshape/other.py", "1", "2", True),
        ("src/preshape/files.py", "1", "2", True),
        ("src/preshape/tracking/store.py", "1", "2", True),
        ("sim/pictures.py", "Pictures.", "Fine pictures.", True),
        ("src/preshape/glass.py", "INDEX = 1.5", "INDEX = (1.5)  # of crown glass", True),
    ],
)
def test_the_digest_follows_the_code(root: Path, name: str, old: str, new: str, same: bool) -> None:
    before = digest()
    (root / name).write_text(FILES[name].replace(old, new))
    assert (digest() == before) is same
    module.source_digest.cache_clear()


def test_modules_that_decide_nothing_are_there() -> None:
    stems = [SOURCES.joinpath(*name.split(".")[1:]) for name in module.DECIDES_NOTHING]
    assert [stem for stem in stems if not (stem.is_dir() or stem.with_suffix(".py").is_file())] == []


def test_the_real_renderer_and_perception_are_covered() -> None:
    module.source_digest.cache_clear()
    modules = ("sim.scene_renderer", "preshape.data.view_cache")
    assert len({module.source_digest(name) for name in modules}) == 2
