"""The examples of the documents run."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "docs" / name for name in ("data_card.md", "data_format.md")]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_examples_of_the_data_documents_run(document: Path) -> None:
    examples = re.findall(r"```python\n(.*?)```", document.read_text(encoding="utf-8"), re.DOTALL)
    assert examples
    for example in examples:
        done = subprocess.run(
            [sys.executable, "-c", example], cwd=ROOT, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout


NAMED = re.compile(r"`([\w/]+\.(?:py|yaml))`:\n\n```\w+\n(.*?)```", re.DOTALL)
"""A file of an example: its name, and what stands in it."""
BUILD = """
from pathlib import Path
import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate
import preshape.command_line.entry_point

@pytest.mark.parametrize(("command", "made"), CHOSEN.items())
def test_they_are_chosen_and_built(command, made):
    name, *choices = command.split()
    with initialize_config_dir(str(Path(__file__).parents[2] / "conf"), version_base="1.3"):
        cfg = compose(name, choices)
    for path, type_name in made.items():
        part = cfg
        for key in path.split("."):
            part = part[key]
        assert type(instantiate(part)).__name__ == type_name
"""
CHOSEN = {
    "train model=mean_image dataset=bricks": {
        "model": "MeanImage",
        "learning.settings": "LearningSettings",
        "dataset.data.origin": "TableOrigin",
    },
    "plan planner=coordinate_search": {"planner.method": "CoordinateSearchPlanner"},
    "plan robot=lbr4_three_finger": {"robot.clearance": "HandClearance", "planner.method": "GradientAscent"},
    "collect objects=bricks robot=lbr4_allegro_long": {
        "objects.set": "Bricks",
        "robot.description.settings": "RobotSettings",
    },
}
"""How the examples are chosen; what of them is built, and its type."""


def test_parts_are_added_by_the_files_that_the_page_shows(tmp_path: Path) -> None:
    for name in ("conf", "src", "sim", "tests"):
        shutil.copytree(ROOT / name, tmp_path / name)
    (tmp_path / "pyproject.toml").symlink_to(ROOT / "pyproject.toml")
    examples = dict(NAMED.findall((ROOT / "docs" / "extending.md").read_text(encoding="utf-8")))
    assert {name.split("/")[1] for name in examples if name.startswith("conf/")} == {
        "model",
        "planner",
        "objects",
        "robot",
        "dataset",
    }
    for name, text in examples.items():
        assert not (tmp_path / name).exists()
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "tests" / "unit" / "test_built.py").write_text(
        f"CHOSEN = {CHOSEN}\n{BUILD}", encoding="utf-8"
    )
    own_tests = [name for name in examples if name.startswith("tests/")]
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-o",
            "addopts=-p no:dash -p no:cacheprovider",
            *own_tests,
            "tests/unit/test_built.py",
        ],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path / 'src'}:{tmp_path}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert f"{len(own_tests) + len(CHOSEN)} passed" in done.stdout, done.stdout + done.stderr
