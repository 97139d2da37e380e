"""The report about learning shows what was run or was recorded, and says what was not."""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from synthetic_folds import IDENTITY, write_fold, write_grasp_fold, write_group

from analysis.learning.report import LearningReport
from preshape.errors import InputError
from preshape.evaluation.fold_summary import summarise
from preshape.files import read_json, write_json

FOLDS = ("seen_fold0", "seen_fold1", "unseen_fold0", "unseen_fold1")
OTHERS = {**IDENTITY, "settings": "others"}


def report(folder: Path) -> LearningReport:
    return LearningReport(
        runs=str(folder / "train"),
        record=str(folder / "folds"),
        paper={"config_cnn": "paper", "patches_cnn": "patches", "regression": "regression"},
        default="best",
        ablations={"Patches": {"fixed": "paper", "moving": "moving"}},
        calibrated=["paper"],
        learning_curves={"config-CNN": {"all": "paper", "fewer": "curve"}},
        output=str(folder / "cross_validation.json"),
        page=str(folder / "results.md"),
        seed=0,
    )


def written(folder: Path) -> dict[str, bytes]:
    """Make the report anew; what its files hold."""
    for name in ("cross_validation.json", "results.md", "pictures"):
        shutil.rmtree(folder / name, ignore_errors=True)
        (folder / name).unlink(missing_ok=True)
    report(folder).write()
    files = (folder / "cross_validation.json", folder / "results.md", *sorted(folder.glob("pictures/*")))
    return {path.name: path.read_bytes() for path in files}


def recorded(folder: Path) -> set[str]:
    return {str(path.parent.relative_to(folder / "folds")) for path in folder.glob("folds/*/*/metrics.json")}


def runs_of(folder: Path) -> dict[tuple[str, str], list[int]]:
    report(folder).write()
    runs = read_json(folder / "cross_validation.json")["runs"]
    return {(run["group"], run["split"]): run["folds"] for run in runs}


def write_everything(train: Path) -> None:
    """Sweeps of all kinds that the report knows, and one that it does not."""
    for name in ("paper", "best"):
        write_group(train / name, *FOLDS)
    write_group(train / "mini_best", "seen_fold0")
    write_group(train / "curve,trials_learned=150", "unseen_fold0", trials_learned=150)
    write_grasp_fold(train / "regression" / "seen_fold0")
    summarise(train / "regression", IDENTITY)


def test_what_was_run_stands_beside_the_paper_and_what_was_not_is_named(tmp_path: Path) -> None:
    paper = tmp_path / "train" / "paper"
    areas = [write_fold(paper / f"unseen_fold{fold}").auc for fold in (0, 1)]
    summarise(paper, IDENTITY)
    write_group(tmp_path / "train" / "curve,trials_learned=150", "unseen_fold0", trials_learned=150)
    assert "2 runs" in report(tmp_path).write()

    content = read_json(tmp_path / "cross_validation.json")
    assert list(content)[:5] == ["command", "git_revision", "versions", "seed", "date"]
    (run,) = (run for run in content["runs"] if run["group"] == "paper")
    assert (run["experiment"], run["model"], run["split"], run["n"]) == ("paper", "config_cnn", "unseen", 120)
    assert run["auc"]["folds"] == areas
    assert run["auc"]["mean"] == pytest.approx(np.mean(areas))
    assert {"positives", "ap", "brier", "ece", "accuracy", "f1"} <= set(run)

    page = (tmp_path / "results.md").read_text()
    (ours,) = (
        line for line in page.splitlines() if line.startswith("| config-CNN, as in the paper | unseen")
    )
    assert f"{np.mean(areas):.3f} ± {np.std(areas):.3f}" in ours
    assert "| paper, config-CNN | unseen | 5 | 1,507 | 159 | 0.82 ± 0.06 |" in page
    for missing in ("| default model | seen |", "| patches-CNN, as in the paper | unseen |", "| moving |"):
        (line,) = (line for line in page.splitlines() if line.startswith(missing))
        assert "*not run*" in line
    pictures = {path.name for path in (tmp_path / "pictures").iterdir()}
    shown = ("learning_curves", "reliability", "roc_config_cnn", "training_curves")
    assert pictures == {f"learning_{name}.png" for name in shown}
    assert all(name in page for name in pictures)


@pytest.mark.parametrize("left", ["nothing", "an empty folder"])
def test_the_record_alone_makes_the_same_report(tmp_path: Path, left: str) -> None:
    write_everything(tmp_path / "train")
    measured = written(tmp_path)
    assert len(measured) == 2 + 5  # result file, page and all pictures
    shutil.rmtree(tmp_path / "train")
    if left == "an empty folder":
        (tmp_path / "train").mkdir()
    kept = {path: path.stat().st_ino for path in (tmp_path / "folds").rglob("*")}
    assert written(tmp_path) == measured
    assert {path: path.stat().st_ino for path in (tmp_path / "folds").rglob("*")} == kept


def differences(folder: Path) -> list[dict[str, Any]]:
    report(folder).write()
    found: list[dict[str, Any]] = read_json(folder / "cross_validation.json")["differences"]
    return found


def test_networks_of_an_ablation_are_compared_on_the_trials_that_both_were_tested_with(
    tmp_path: Path,
) -> None:
    train = tmp_path / "train"
    write_group(train / "paper", *FOLDS[:3])
    areas = [write_fold(train / "moving" / name, trained=7).auc for name in FOLDS[1:]]
    summarise(train / "moving", IDENTITY)
    seen, unseen = differences(tmp_path)
    assert (seen["group"], seen["less"], seen["split"]) == ("moving", "paper", "seen")
    assert (seen["folds"], seen["n"], unseen["folds"]) == ([1], 60, [0])
    for found, name, area in ((seen, FOLDS[1], areas[0]), (unseen, FOLDS[2], areas[1])):
        expected = area - write_fold(tmp_path / "again" / name).auc
        assert found["auc"]["value"] == pytest.approx(expected, abs=1e-6)
        assert found["auc"]["low"] <= found["auc"]["value"] <= found["auc"]["high"]
    shown = [
        line for line in (tmp_path / "results.md").read_text().splitlines() if line.startswith("| moving | ")
    ]
    assert len(shown) == 1 + 2
    assert f"{seen['auc']['value']:+.3f} [" in shown[1]


def test_folds_with_other_trials_are_not_compared(tmp_path: Path) -> None:
    train = tmp_path / "train"
    for group in ("paper", "moving"):
        write_group(train / group, "seen_fold0", "seen_fold1")
    for name, column in (("seen_fold0", "trial_id"), ("seen_fold1", "scene_id")):
        path = train / "moving" / name / "predictions.parquet"
        table = pd.read_parquet(path)
        table.assign(**{column: table[column] + 1}).to_parquet(path)
    assert differences(tmp_path) == []


def test_a_learning_curve_is_of_the_folds_that_all_its_points_have(tmp_path: Path) -> None:
    train = tmp_path / "train"
    few = "curve,trials_learned=150"
    write_group(train / "paper", *FOLDS)
    area = write_fold(train / few / "unseen_fold1", trained=7, trials_learned=150).auc
    summarise(train / few, IDENTITY)
    report(tmp_path).write()
    (row,) = (
        line
        for line in (tmp_path / "results.md").read_text().splitlines()
        if "config-CNN | unseen | 0" in line
    )
    whole = write_fold(tmp_path / "again" / "unseen_fold1").auc
    assert row.startswith(f"| config-CNN | unseen | {area:.3f} | *not run*")
    assert row.endswith(f"| {whole:.3f} |")


def test_regression_that_says_one_grasp_whatever_it_sees_is_named(tmp_path: Path) -> None:
    train = tmp_path / "train" / "regression"
    for fold in range(3):
        write_grasp_fold(train / f"unseen_fold{fold}", collapsed=fold == 1)
    summarise(train, IDENTITY)
    report(tmp_path).write()
    page = (tmp_path / "results.md").read_text()
    assert "In fold 1 of unseen objects the network says one grasp, whatever it sees." in page
    assert "of seen objects the network says" not in page


def test_sweeps_may_be_left_out(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    before = written(tmp_path)
    write_group(tmp_path / "train" / "best", *FOLDS)
    replace(report(tmp_path), runs=None).write()
    assert (tmp_path / "cross_validation.json").read_bytes() == before["cross_validation.json"]


def test_only_groups_that_the_report_names_are_read_and_recorded(tmp_path: Path) -> None:
    for name in ("moving", "mini_best"):
        write_group(tmp_path / "train" / name, "seen_fold0")
    assert runs_of(tmp_path) == {("moving", "seen"): [0]}
    assert recorded(tmp_path) == {"moving/seen_fold0"}
    shutil.copytree(tmp_path / "train" / "mini_best", tmp_path / "folds" / "mini_best")
    assert runs_of(tmp_path) == {("moving", "seen"): [0]}


def test_folds_of_several_places_come_together(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS[:3])
    report(tmp_path).write()
    shutil.rmtree(tmp_path / "train")
    write_group(tmp_path / "train" / "moving", FOLDS[3])
    write_group(tmp_path / "train" / "patches", FOLDS[0])
    assert runs_of(tmp_path) == {
        ("moving", "seen"): [0, 1],
        ("moving", "unseen"): [0, 1],
        ("patches", "seen"): [0],
    }


def test_a_fold_that_was_run_again_wins(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    report(tmp_path).write()
    shutil.rmtree(tmp_path / "train")
    later = {**IDENTITY, "code": "later"}
    write_group(tmp_path / "train" / "moving", "seen_fold0", identity=later, trained=7)
    found = written(tmp_path)
    shutil.rmtree(tmp_path / "train")
    assert written(tmp_path) == found
    (run,) = (run for run in read_json(tmp_path / "cross_validation.json")["runs"] if run["split"] == "seen")
    area = write_fold(tmp_path / "again" / "seen_fold0", trained=7).auc
    assert run["auc"]["folds"][0] == area
    assert run["folds"] == [0, 1]


def test_folds_with_other_settings_replace_the_recorded_ones(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    write_group(tmp_path / "train" / "patches", *FOLDS[:1])
    report(tmp_path).write()
    shutil.rmtree(tmp_path / "train")
    write_group(tmp_path / "train" / "moving", "seen_fold1", identity=OTHERS)
    assert runs_of(tmp_path) == {("moving", "seen"): [1], ("patches", "seen"): [0]}
    assert recorded(tmp_path) == {"moving/seen_fold1", "patches/seen_fold0"}


def test_folds_of_a_sweep_with_other_settings_than_its_last_ones_are_left_out(tmp_path: Path) -> None:
    write_fold(tmp_path / "train" / "moving" / "seen_fold0", identity=OTHERS)
    write_group(tmp_path / "train" / "moving", "seen_fold1")
    assert runs_of(tmp_path) == {("moving", "seen"): [1]}
    assert recorded(tmp_path) == {"moving/seen_fold1"}


def test_a_sweep_that_has_no_fold_yet_leaves_the_record_alone(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    report(tmp_path).write()
    write_json(tmp_path / "train/moving/summary.json", {"identity": OTHERS})
    assert runs_of(tmp_path) == {("moving", "seen"): [0, 1], ("moving", "unseen"): [0, 1]}


def test_figures_that_not_all_folds_have_are_left_out(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    path = tmp_path / "train/moving/seen_fold0/metrics.json"
    content = read_json(path)
    content["scalars"]["temperature"] = 1.5  # as code that came later measures
    write_json(path, content)
    report(tmp_path).write()
    assert all("temperature" not in run for run in read_json(tmp_path / "cross_validation.json")["runs"])


@pytest.mark.parametrize("file", ["metrics.json", "predictions.parquet", "curves.json"])
def test_a_damaged_fold_is_refused_and_changes_nothing(tmp_path: Path, file: str) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    before = written(tmp_path)
    path = tmp_path / "folds" / "moving" / "seen_fold1" / file
    path.write_bytes(path.read_bytes()[:30])
    shutil.rmtree(tmp_path / "train")
    with pytest.raises(InputError) as refusal:
        report(tmp_path).write()
    assert (refusal.value.where, "git" in refusal.value.fix) == (str(path), True)
    assert (tmp_path / "cross_validation.json").read_bytes() == before["cross_validation.json"]


def test_a_damaged_fold_of_a_sweep_is_not_recorded(tmp_path: Path) -> None:
    write_group(tmp_path / "train" / "moving", *FOLDS)
    (tmp_path / "train/moving/unseen_fold1/curves.json").write_text("{}")
    with pytest.raises(InputError, match="does not say points"):
        report(tmp_path).write()
    assert recorded(tmp_path) == set()


@pytest.mark.parametrize("content", [{}, {"identity": 3}, {"identity": {"settings": "s"}}])
def test_a_summary_that_does_not_say_what_its_folds_share_is_refused(
    tmp_path: Path, content: dict[str, object]
) -> None:
    write_group(tmp_path / "train" / "moving", "seen_fold0")
    write_json(tmp_path / "train/moving/summary.json", content)
    with pytest.raises(InputError, match=r"summary\.json"):
        report(tmp_path).write()


def test_neither_sweep_nor_record_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no finished fold"):
        report(tmp_path).write()
    assert not (tmp_path / "cross_validation.json").exists()
