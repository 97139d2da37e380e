"""The collection's result file takes its figures from the files that were measured, about the same trials."""

from pathlib import Path

import pytest

from analysis.dataset.collection_figures import ABOUT_TRIALS, CollectionFigures
from preshape.errors import InputError
from preshape.files import read_json, write_json

DATASET = dict.fromkeys(ABOUT_TRIALS, 0.5) | {"executed": 40, "lifted": 20, "objects": 5}
VARIANTS = {"unchanged": {"n": 20, "flips": 0}, "no_early_stop": {"n": 50, "flips": 1}}
FILES = {
    "dataset": {"data": "abc", "seed": 3, **DATASET},
    "effort": {"executed": 40, "seconds": 20.0, "workers": 2, "executed_per_hour": 7200.0},
    "crash_test": {"kills": 25, "tables": 5, "differing_rows": 0},
    "sensitivity": {"data": "abc", "variants": VARIANTS},
    "label_check": {"data": "abc", "n": 100, "disagreements": 2},
}


def figures(folder: Path) -> CollectionFigures:
    for name, content in FILES.items():
        if not (folder / f"{name}.json").exists():
            write_json(folder / f"{name}.json", content)
    paths = {name: str(folder / f"{name}.json") for name in FILES}
    return CollectionFigures(**paths, output=str(folder / "collection.json"))


def test_the_agreed_figures_come_from_the_measured_files(tmp_path: Path) -> None:
    assert "7200 an hour with 2 workers" in figures(tmp_path).write()
    content = read_json(tmp_path / "collection.json")
    assert list(content)[:5] == ["command", "git_revision", "versions", "seed", "date"]
    assert (content["objects"], content["executed"], content["lifted"], content["seed"]) == (5, 40, 20, 3)
    assert (content["flips_under_repeated_seeds"], content["flips_without_early_stop"]) == (0, 1)
    assert (content["kill_tests"], content["differing_rows_after_kills"]) == (25, 0)
    assert (content["labels_looked_at"], content["label_disagreements"]) == (100, 2)
    assert content["speed"]["workers"] == 2


def test_figures_about_another_table_are_refused(tmp_path: Path) -> None:
    write_json(tmp_path / "label_check.json", FILES["label_check"] | {"data": "another"})
    with pytest.raises(InputError, match="another table"):
        figures(tmp_path).write()


@pytest.mark.parametrize("name", FILES)
def test_a_file_that_lacks_figures_is_named(tmp_path: Path, name: str) -> None:
    write_json(tmp_path / f"{name}.json", {"seed": 1})
    with pytest.raises(InputError, match="does not say") as refusal:
        figures(tmp_path).write()
    assert name in str(refusal.value)
