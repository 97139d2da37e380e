"""What was measured once stays measured: finished folds are recorded, and foreign files refused."""

import subprocess
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from synthetic_folds import IDENTITY, write_fold, write_grasp_fold

from analysis.learning.fold_files import FILES, read_fold
from analysis.learning.fold_record import FoldRecord
from preshape.errors import InputError
from preshape.evaluation.fold_summary import FoldResult
from preshape.files import read_json, write_json

ROOT = Path(__file__).parents[3]
OTHERS = {**IDENTITY, "settings": "others"}


@pytest.fixture
def record(tmp_path: Path) -> FoldRecord:
    """A record that holds nothing yet."""
    return FoldRecord(tmp_path / "record")


def measured(folder: Path, **about: Any) -> FoldResult:
    write_fold(folder, **about)
    return read_fold(folder)


def names(record: FoldRecord) -> list[str]:
    return [fold.folder.name for fold in record.folds("paper")]


def taken(tmp_path: Path, record: FoldRecord) -> Path:
    """A recorded fold."""
    record.take("paper", [measured(tmp_path / "seen_fold0")])
    return record.folder / "paper" / "seen_fold0"


def test_a_recorded_fold_is_what_was_measured(tmp_path: Path, record: FoldRecord) -> None:
    fold = measured(tmp_path / "unseen_fold3")
    record.take("paper", [fold])
    (kept,) = record.folds("paper")
    assert kept.content == fold.content
    for own, theirs in zip(kept.predictions() or (), fold.predictions() or (), strict=True):
        assert own.tolist() == theirs.tolist()
    assert read_json(kept.folder / "curves.json") == read_json(fold.folder / "curves.json")
    assert {path.name for path in kept.folder.iterdir()} == set(FILES)


def test_only_columns_that_are_read_are_kept(tmp_path: Path, record: FoldRecord) -> None:
    write_grasp_fold(tmp_path / "seen_fold1")
    record.take("paper", [measured(tmp_path / "seen_fold0"), read_fold(tmp_path / "seen_fold1")])
    known = ["trial_id", "scene_id"]
    tables = [pd.read_parquet(fold.folder / "predictions.parquet") for fold in record.folds("paper")]
    assert [list(table) for table in tables] == [
        [*known, "lifted", "success_prob"],
        [*known, "theta_predicted"],
    ]
    assert record.folds("paper")[1].predictions() is None


def test_folds_come_together_from_several_places(tmp_path: Path, record: FoldRecord) -> None:
    for place, own in (("one", ("unseen_fold1", "seen_fold0")), ("other", ("unseen_fold0",))):
        record.take("paper", [measured(tmp_path / place / name) for name in own])
    record.take("another", [measured(tmp_path / "seen_fold4")])
    assert record.groups() == ["another", "paper"]
    assert names(record) == ["seen_fold0", "unseen_fold0", "unseen_fold1"]


def test_a_fold_that_was_measured_again_takes_the_place_of_the_old_one(
    tmp_path: Path, record: FoldRecord
) -> None:
    record.take("paper", [measured(tmp_path / "old" / name) for name in ("seen_fold0", "seen_fold1")])
    again = measured(tmp_path / "new" / "seen_fold0", trained=7, identity={**IDENTITY, "code": "later"})
    record.take("paper", [again])
    replaced, other = record.folds("paper")
    assert replaced.content == again.content
    assert other.content == read_fold(tmp_path / "old" / "seen_fold1").content


@pytest.mark.parametrize("decisive", ["settings", "data"])
def test_folds_with_other_settings_or_data_go(
    tmp_path: Path, record: FoldRecord, decisive: str, caplog: pytest.LogCaptureFixture
) -> None:
    record.take("paper", [measured(tmp_path / "old" / name) for name in ("seen_fold0", "seen_fold1")])
    record.take("another", [measured(tmp_path / "old" / "seen_fold0")])
    others = measured(tmp_path / "new" / "seen_fold1", identity={**IDENTITY, decisive: "others"})
    with caplog.at_level("WARNING"):
        record.take("paper", [others])
    assert names(record) == ["seen_fold1"]
    assert record.folds("paper")[0].content == others.content
    assert not (record.folder / "paper" / "seen_fold0").exists()
    assert len(record.folds("another")) == 1
    assert "seen_fold0, seen_fold1" in caplog.text


def test_of_two_kinds_in_a_record_the_later_one_counts(tmp_path: Path, record: FoldRecord) -> None:
    group = record.folder / "paper"
    write_fold(group / "seen_fold0", date="2026-03-01", identity=OTHERS)
    write_fold(group / "seen_fold1", date="2026-02-01", identity=OTHERS)
    write_fold(group / "unseen_fold0", date="2026-02-28")
    assert names(record) == ["seen_fold0", "seen_fold1"]
    assert (group / "unseen_fold0" / "metrics.json").is_file()  # reading changes nothing


def test_what_is_recorded_already_is_not_written_again(tmp_path: Path, record: FoldRecord) -> None:
    folder = taken(tmp_path, record)
    before = {path: path.stat().st_ino for path in folder.iterdir()}  # an atomic write makes another file
    taken(tmp_path, record)
    assert {path: path.stat().st_ino for path in folder.iterdir()} == before


def test_a_fold_without_its_figures_is_not_finished_and_is_made_whole(
    tmp_path: Path, record: FoldRecord
) -> None:
    folder = taken(tmp_path, record)
    (folder / "metrics.json").unlink()
    assert record.folds("paper") == []
    taken(tmp_path, record)
    assert names(record) == ["seen_fold0"]


def test_an_interrupt_leaves_no_half_of_a_fold(
    tmp_path: Path, record: FoldRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken(tmp_path, record)
    again = measured(tmp_path / "new" / "seen_fold0", trained=7)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("analysis.learning.fold_record.write_json", interrupt)
        with pytest.raises(KeyboardInterrupt):
            record.take("paper", [again])
    assert record.folds("paper") == []
    record.take("paper", [again])
    assert record.folds("paper")[0].content == again.content


@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("content", [b"{", b"[1]", b'{"points": [3]}', b'{"identity": 3}', b"PAR1PAR1"])
def test_a_damaged_file_is_refused(tmp_path: Path, record: FoldRecord, file: str, content: bytes) -> None:
    path = taken(tmp_path, record) / file
    path.write_bytes(content)
    with pytest.raises(InputError) as refusal:
        record.folds("paper")
    assert refusal.value.where == str(path)
    assert "git" in refusal.value.fix


@pytest.mark.parametrize("file", ["predictions.parquet", "curves.json"])
def test_a_missing_file_is_refused(tmp_path: Path, record: FoldRecord, file: str) -> None:
    path = taken(tmp_path, record) / file
    path.unlink()
    with pytest.raises(InputError) as refusal:
        record.folds("paper")
    assert refusal.value.where == str(path)


def test_files_of_another_fold_are_refused(tmp_path: Path, record: FoldRecord) -> None:
    folder = taken(tmp_path, record)
    write_fold(tmp_path / "seen_fold1")
    (folder / "predictions.parquet").write_bytes((tmp_path / "seen_fold1/predictions.parquet").read_bytes())
    with pytest.raises(InputError, match="predictions are not those"):
        record.folds("paper")
    (tmp_path / "seen_fold1").rename(record.folder / "paper" / "seen_fold2")
    folder.rename(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="not the figures of seen_fold2"):
        record.folds("paper")


@pytest.mark.parametrize("scalar", ["auc", "n", "brier", "random_f1"])
def test_figures_without_one_that_is_shown_are_refused(
    tmp_path: Path, record: FoldRecord, scalar: str
) -> None:
    path = taken(tmp_path, record) / "metrics.json"
    content = read_json(path)
    del content["scalars"][scalar]
    write_json(path, content)
    with pytest.raises(InputError, match="not the figures of seen_fold0"):
        record.folds("paper")


def _take(record: FoldRecord, folder: Path) -> int:
    with record.locked():
        record.take("paper", [read_fold(path) for path in sorted(folder.iterdir())])
        return len(record.folds("paper"))


def test_several_processes_may_record_at_a_time(tmp_path: Path, record: FoldRecord) -> None:
    places = [tmp_path / name for name in ("one", "other")]
    for number, place in enumerate(places):
        for name in ("seen_fold0", "seen_fold1"):
            write_fold(place / name, trained=number)
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
        found = list(pool.map(_take, [record] * 6, places * 3))
    assert found == [2] * 6


def test_the_record_is_versioned() -> None:
    paths = [f"results/folds/palm_points,members=1/seen_fold0/{name}" for name in FILES]
    known = subprocess.run(["git", "check-ignore", "--no-index", *paths], cwd=ROOT, capture_output=True)
    assert known.stdout == b""
