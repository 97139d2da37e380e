"""A revision says whether a result can depend on what is not in it."""

import subprocess
from pathlib import Path

import pytest

from preshape.provenance import TYPED_COMMAND, git_revision, provenance


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout whose tracked files are all as in its one commit."""
    for name in ("src/train.py", "conf/train.yaml", "results/folds/a.json", "docs/results.md", "dvc.lock"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("as committed")
    author = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    for arguments in (("init", "-q"), ("add", "."), (*author, "commit", "-qm", "Begin")):
        subprocess.run(["git", *arguments], cwd=tmp_path, check=True)
    return tmp_path


def test_a_revision_is_that_of_the_commit(checkout: Path) -> None:
    head = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=checkout, capture_output=True, text=True, check=True
    )
    assert git_revision(checkout) == head.stdout[:12]
    (checkout / "outputs").mkdir()
    (checkout / "outputs" / "untracked.json").write_text("{}")
    assert git_revision(checkout / "src") == head.stdout[:12]


@pytest.mark.parametrize("name", ["src/train.py", "conf/train.yaml"])
def test_changed_code_and_configuration_are_said(checkout: Path, name: str) -> None:
    (checkout / name).write_text("changed")
    assert git_revision(checkout).endswith("-dirty")


@pytest.mark.parametrize("name", ["results/folds/a.json", "docs/results.md", "dvc.lock"])
def test_what_commands_write_themselves_is_no_change(checkout: Path, name: str) -> None:
    """Else every stage but the first of a pipeline would seem to be made by other code."""
    (checkout / name).write_text("written by the stage before")
    assert not git_revision(checkout).endswith("-dirty")


def test_outside_a_checkout_the_revision_is_unknown(tmp_path: Path) -> None:
    assert git_revision(tmp_path) == "unknown"


def test_a_result_names_no_place_of_derived_files(monkeypatch: pytest.MonkeyPatch) -> None:
    typed = "python src/train.py paths.cache=/a/.cache split=seen paths.outputs=/a/out root=../data"
    monkeypatch.setenv(TYPED_COMMAND, typed)
    assert provenance(0)["command"] == "python src/train.py split=seen root=../data"
