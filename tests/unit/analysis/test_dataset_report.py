"""The report of a data set says what its table says, in figures, pages and small pictures."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from synthetic_scenes import ORIGIN, SIZES_M, allegro_space, make_scene, make_trial

from analysis.dataset.grasps import grasp_frame, read_families
from analysis.dataset.rates import binned_rates, frame_rate, gridded_counts
from analysis.dataset.report import PICTURES, DatasetReport
from preshape.data.tables import write_data_set
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.errors import InputError
from preshape.evaluation.intervals import wilson
from preshape.files import read_json, write_json
from preshape.geometry.pose import invert_pose, make_pose

FLIPS = {
    "overrides": [],
    "n": 20,
    "flips": 3,
    "share": 0.15,
    "low": 0.05,
    "high": 0.36,
    "lifted_before": 10,
    "lifted_after": 11,
    "not_executed": 0,
    "identical": 0,
    "soft_labels": {"lifted": {"0.40": 1, "1.00": 9}, "not_lifted": {"0.40": 9, "1.00": 1}},
}
SHIFT_M = np.array((0.03, 0.0, -0.04))


@pytest.fixture(scope="module")
def data_set() -> tuple[SceneTable, TrialTable]:
    """Twelve scenes with three heuristic trials, and the same three with their palms moved by 5 cm."""
    scenes = [make_scene(i) for i in range(12)]
    trials = []
    for scene in scenes:
        for i in range(3):
            trial = make_trial(6 * scene.scene_id + i, scene)
            moved = trial.planned + np.concatenate((SHIFT_M, np.zeros(11)))
            trials += [
                trial,
                replace(trial, trial_id=trial.trial_id + 3, planner="exploration", planned=moved),
            ]
    table = TrialTable.from_trials(trials, allegro_space(), ORIGIN)
    return SceneTable(ORIGIN, tuple(scenes)), table


@pytest.fixture(scope="module")
def grasps(data_set: tuple[SceneTable, TrialTable]) -> pd.DataFrame:
    return grasp_frame(*data_set, {"box_0": "tall"})


def test_geometry_is_that_of_the_palm(grasps: pd.DataFrame, data_set: tuple[SceneTable, TrialTable]) -> None:
    scenes, trials = data_set
    for i in (0, 7, 31):
        scene = scenes.by_id[int(trials.scene_ids[i])]
        T_world_palm = scene.camera.T_world_camera @ trials.space.palm_pose(trials.planned[i])
        centre = (invert_pose(T_world_palm) @ scene.T_world_object)[:3, 3]
        row = grasps.loc[i, ["centre_x_m", "centre_y_m", "centre_z_m"]].to_numpy(dtype=float)
        np.testing.assert_allclose(row, centre, atol=1e-9)
    explored = grasps["planner"] == "exploration"
    np.testing.assert_allclose(grasps.loc[explored, "shift_m"], np.linalg.norm(SHIFT_M), atol=1e-9)
    np.testing.assert_allclose(grasps.loc[explored, "tilt_rad"], 0.0, atol=1e-6)
    assert grasps.loc[~explored, ["shift_m", "tilt_rad"]].isna().all(axis=None)


def test_a_tilted_palm_has_its_angle(data_set: tuple[SceneTable, TrialTable]) -> None:
    scenes, table = data_set
    first, second = table.to_trials()[:2]
    pose = table.space.palm_pose(first.planned)
    turn = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
    turned = table.space.theta(make_pose(pose[:3, :3] @ turn, pose[:3, 3]), first.planned[6:])
    pair = TrialTable.from_trials([first, replace(second, planned=turned)], table.space, ORIGIN)
    assert grasp_frame(scenes, pair, {})["tilt_rad"].iloc[1] == pytest.approx(0.3)


def test_ranges_and_cells_count_every_executed_grasp_once(grasps: pd.DataFrame) -> None:
    rate = frame_rate(grasps)
    for column in ("index_0", "centre_x_m", "success_prob"):
        bins = binned_rates(grasps, column, 5)
        known = grasps[grasps["executed"] & grasps[column].notna()]
        assert sum(entry.rate.executed for entry in bins) == len(known)
        assert sum(entry.rate.lifted for entry in bins) == known["lifted"].sum()
        assert all(low.high == high.low for low, high in pairwise(bins))
    same = binned_rates(grasps.assign(thumb=1.4), "thumb", 5)
    assert [entry.rate for entry in same] == [rate]
    lifted, executed = gridded_counts(grasps, ("object_x_m", "object_y_m"), np.linspace(-0.3, 0.3, 5))
    assert (lifted.sum(), executed.sum()) == (rate.lifted, rate.executed)
    assert (lifted <= executed).all()


def report(folder: Path, **changes: str | None) -> DatasetReport:
    parts = {"sensitivity": None, "label_check": None, "families": None} | changes
    return DatasetReport(
        data=str(folder),
        output=str(folder / "dataset.json"),
        card=str(folder / "card.md"),
        page=str(folder / "results.md"),
        seed=0,
        space=allegro_space(),
        **parts,
    )


def test_report_holds_figures_pages_and_small_pictures(
    data_set: tuple[SceneTable, TrialTable], tmp_path: Path
) -> None:
    write_data_set(tmp_path, *data_set)
    families = tmp_path / "families.csv"
    families.write_text("name,family\n" + "".join(f"{name},tall_box\n" for name in list(SIZES_M)[:3]))
    write_json(
        tmp_path / "flips.json", {"command": "c", "git_revision": "r", "seed": 0, "variants": {"x": FLIPS}}
    )
    found = {"n": 9, "seed": 1, "disagreements": 0, "how": "by eye"}
    write_json(tmp_path / "check.json", found | {"git_revision": "r", "repeated_differently": 0})
    written = report(
        tmp_path,
        families=str(families),
        sensitivity=str(tmp_path / "flips.json"),
        label_check=str(tmp_path / "check.json"),
    )
    assert str(written.output) in written.write()
    figures, trials = read_json(written.output), data_set[1]
    assert figures["planned"] == len(trials)
    assert (figures["executed"], figures["lifted"]) == (len(trials.executed), trials.lifted.sum())
    assert [figures["low"], figures["high"]] == list(wilson(figures["lifted"], figures["executed"]))
    for groups in ("planners", "faces", "planners_and_faces", "families", "object_rates"):
        assert sum(rate["executed"] for rate in figures[groups].values()) == figures["executed"]
        assert sum(rate["lifted"] for rate in figures[groups].values()) == figures["lifted"]
    assert set(figures["families"]) == {"tall box", "other"}
    one_sided = figures["objects_never_lifted"] + figures["objects_always_lifted"]
    assert figures["objects_with_both_outcomes"] + len(one_sided) == figures["objects"] == len(SIZES_M)
    assert figures["label_check"]["disagreements"] == 0
    card = (tmp_path / "card.md").read_text()
    for name in PICTURES:
        assert f"(pictures/dataset_{name}.png)" in card
        with Image.open(tmp_path / "pictures" / f"dataset_{name}.png") as picture:
            assert min(picture.size) > 100
        assert (tmp_path / "pictures" / f"dataset_{name}.png").stat().st_size < 150_000
    assert "| `x` | 20 | 3 | 15.0 % |" in card
    assert "| not lifted | 9 | 1 |" in card
    assert "**0**. Looked at: by eye." in card
    assert f"| executed | {figures['executed']} |" in (tmp_path / "results.md").read_text()


def test_a_table_without_families_is_refused(tmp_path: Path) -> None:
    (tmp_path / "names.csv").write_text("name,size\nbox_0,3\n")
    for path in (tmp_path / "names.csv", tmp_path / "missing.csv"):
        with pytest.raises(InputError, match="shape families"):
            read_families(path)
