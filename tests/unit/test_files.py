"""Files appear whole or not at all."""

import errno
import json
import stat
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from preshape.errors import InputError
from preshape.files import atomic_path, copy_files, read_json, write_json


def test_file_appears_only_at_the_end(tmp_path: Path) -> None:
    target = tmp_path / "new folder" / "picture.png"
    with atomic_path(target) as temporary:
        temporary.write_bytes(b"whole")
        assert not target.exists()
        assert temporary.suffix == ".png"
        assert temporary.parent == target.parent
    assert target.read_bytes() == b"whole"
    assert list(target.parent.iterdir()) == [target]


@pytest.mark.parametrize("interruption", [ValueError, KeyboardInterrupt])
def test_failure_keeps_the_old_file_and_leaves_nothing_else(
    tmp_path: Path, interruption: type[BaseException]
) -> None:
    target = tmp_path / "table.parquet"
    target.write_text("old")
    with pytest.raises(interruption), atomic_path(target) as temporary:
        temporary.write_text("half")
        raise interruption
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_full_disk_is_the_users_to_mend(tmp_path: Path) -> None:
    target = tmp_path / "table.parquet"
    with pytest.raises(InputError, match="No space left") as refusal, atomic_path(target) as temporary:
        temporary.write_text("half")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert refusal.value.where == str(target)
    assert list(tmp_path.iterdir()) == []


def test_folders_are_copied_whole_or_the_place_is_named(tmp_path: Path) -> None:
    for name in ("a.json", "inner/b.bin"):
        path = tmp_path / "source" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(name.encode())
    copy_files(tmp_path / "source", tmp_path / "target")
    copy_files(tmp_path / "nothing", tmp_path / "target")
    assert (tmp_path / "target/a.json").read_bytes() == b"a.json"
    assert (tmp_path / "target/inner/b.bin").read_bytes() == b"inner/b.bin"
    (tmp_path / "no_folder").touch()
    with pytest.raises(InputError, match="no_folder"):
        copy_files(tmp_path / "source", tmp_path / "no_folder")


def test_folder_that_is_a_file_is_the_users_to_mend(tmp_path: Path) -> None:
    (tmp_path / "occupied").write_text("a file")
    with pytest.raises(InputError, match="cannot be written"), atomic_path(tmp_path / "occupied" / "x.json"):
        pass


def test_errors_about_other_files_stay_what_they_are(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), atomic_path(tmp_path / "x.json"):
        (tmp_path / "elsewhere").read_text()


def test_permissions_follow_the_umask(tmp_path: Path) -> None:
    (tmp_path / "usual").write_text("")
    with atomic_path(tmp_path / "ours") as temporary:
        temporary.write_text("")
    usual, ours = (stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("usual", "ours"))
    assert ours == usual


plain_json = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


@settings(max_examples=30, deadline=None)
@given(content=st.dictionaries(st.text(), plain_json))
def test_json_reads_back_what_was_written(
    tmp_path_factory: pytest.TempPathFactory, content: dict[str, object]
) -> None:
    path = tmp_path_factory.mktemp("json") / "content.json"
    write_json(path, content)
    assert read_json(path) == content


def test_json_takes_arrays_and_never_writes_nan(tmp_path: Path) -> None:
    path = tmp_path / "content.json"
    content = {
        "array": np.array([[1.5, np.nan]]),
        "count": np.int64(3),
        "tensor": torch.tensor([0.5, float("inf")]),
        "path": Path("a/b"),
        "missing": float("nan"),
    }
    write_json(path, content)
    expected = {"array": [[1.5, None]], "count": 3, "tensor": [0.5, None], "path": "a/b", "missing": None}
    assert json.loads(path.read_text()) == expected


@pytest.mark.parametrize(
    "text", ["", "{", "[1]", "3", "\x00", "[" * 100_000], ids=lambda text: repr(text[:3])
)
def test_json_that_is_none_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "broken.json"
    path.write_text(text)
    with pytest.raises(InputError) as refusal:
        read_json(path)
    assert refusal.value.where == str(path)


def test_missing_json_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        read_json(tmp_path / "missing.json")
    with pytest.raises(InputError, match="cannot be read"):
        read_json(tmp_path)
