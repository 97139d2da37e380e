"""Folds of a sweep: trained once, summarised together, and again if anything was changed."""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from synthetic_scenes import write_data_set
from tiny_training import SETTINGS, make_data, make_network

from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.tracking.tracked_run import NoTracking
from preshape.training_job import TrainingJob


@pytest.fixture(scope="module")
def data_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    write_data_set(folder, 15)
    return folder


def train_fold(
    group: Path, data: Path, fold: int, changes: dict[str, Any] | None = None, **settings: Any
) -> str:
    job = TrainingJob(
        name="tiny",
        folder=group / f"seen_fold{fold}",
        about={
            "experiment": "default",
            "split": "seen",
            "fold": fold,
            "trials": None,
            "trials_learned": None,
        },
        config={"model": {}},
        unresolved={"model": "tiny", "paths": {"data": str(group)}, **(changes or {})},
        in_sweep=True,
        retrain_after_code_changes=settings.pop("retrain_after_code_changes", True),
    )
    trials = make_data(data, 0.25, split="seen", fold=fold)
    settings.setdefault("learning", replace(SETTINGS.learning, iterations=6))
    return job.run(make_network(), trials, replace(SETTINGS, **settings), NoTracking())


def test_a_sweep_summarises_its_folds_and_trains_them_once(data_folder: Path, tmp_path: Path) -> None:
    group = tmp_path / "tiny"
    assert "(1 fold)" in train_fold(group, data_folder, 0)
    assert "(2 folds)" in train_fold(group, data_folder, 1)
    summary = read_json(group / "summary.json")
    seen = summary["splits"]["seen"]
    areas = [read_json(group / f"seen_fold{fold}" / "metrics.json")["auc"]["value"] for fold in (0, 1)]
    assert seen["metrics"]["auc"]["folds"] == areas
    assert seen["metrics"]["auc"]["mean"] == pytest.approx(np.mean(areas))
    assert (group / "roc_seen.png").is_file()
    assert "had been trained before" in train_fold(group, data_folder, 1)

    assert "had been trained before" not in train_fold(group, data_folder, 1, {"model": "other"})
    assert read_json(group / "summary.json")["splits"]["seen"]["folds"] == [1]


def test_other_code_trains_a_fold_again_unless_it_may_stand(data_folder: Path, tmp_path: Path) -> None:
    group = tmp_path / "tiny"
    train_fold(group, data_folder, 0)
    path = group / "seen_fold0" / "metrics.json"
    content = read_json(path)
    content["identity"]["code"] = "of yesterday"
    write_json(path, content)
    assert "before" in train_fold(group, data_folder, 0, retrain_after_code_changes=False)
    assert "before" not in train_fold(group, data_folder, 0)


def test_a_fold_is_trained_again_from_other_weights(data_folder: Path, tmp_path: Path) -> None:
    group, start = tmp_path / "tiny", tmp_path / "start" / "model.safetensors"
    learning = replace(SETTINGS.learning, iterations=6, start=str(start))
    with pytest.raises(InputError, match="no weights to learn on from"):
        train_fold(group, data_folder, 0, learning=learning)
    train_fold(start.parents[1] / "others", data_folder, 0)
    shutil.copytree(start.parents[1] / "others" / "seen_fold0", start.parent)
    assert "before" not in train_fold(group, data_folder, 0, learning=learning)
    assert "before" in train_fold(group, data_folder, 0, learning=learning)
    for name in (start.name, f"{start.name}.json"):
        shutil.copy(group / "seen_fold0" / name, start.parent / name)
    assert "before" not in train_fold(group, data_folder, 0, learning=learning)


def test_several_devices_are_refused_in_a_sweep(data_folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="one device"):
        train_fold(tmp_path / "tiny", data_folder, 0, devices=2)
