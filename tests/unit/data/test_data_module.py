"""From a folder to batches."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from synthetic_scenes import ORIGIN, SIZES_M, BoxRenderer, allegro_space, write_data_set

from preshape.data.data_module import BatchSettings, GraspDataModule
from preshape.data.folds import HoldOut
from preshape.data.tables import SCENES_FILE, TRIALS_FILE, read_scenes, read_trials, write_trials
from preshape.data.trial_table import TableOrigin
from preshape.data.view_cache import ViewCache
from preshape.errors import InputError

N_SCENES = 15


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    write_data_set(folder, N_SCENES)
    return folder


def make_module(
    folder: Path,
    origin: TableOrigin = ORIGIN,
    trials: int | None = None,
    added: tuple[Path, ...] = (),
    *,
    soft_labels: bool = False,
) -> GraspDataModule:
    return GraspDataModule(
        folder=folder,
        origin=origin,
        space=allegro_space(),
        views=ViewCache(folder / "cache", BoxRenderer()),
        hold_out=HoldOut("scenes", fold=0, validation_fraction=0.25, seed=0),
        batches=BatchSettings(batch_size=4, min_positives=1, batches_per_epoch=5, seed=0),
        added=added,
        trials=trials,
        soft_labels=soft_labels,
    )


def test_executed_trials_become_batches_of_what_was_reached(folder: Path) -> None:
    data = make_module(folder)
    data.setup()
    executed = read_trials(folder / "trials.parquet", allegro_space()).executed
    assert len(data.train) + len(data.validation) + len(data.test) == len(executed)
    known = torch.as_tensor(executed.reached, dtype=torch.float32)
    for batch in data.train_dataloader():
        assert batch.view.patch.shape == (4, 8, 400, 400)
        assert batch.label.sum() >= 1
        rows = [int((known == theta).all(dim=1).nonzero()) for theta in batch.theta]
        assert batch.label.bool().tolist() == executed.lifted[rows].tolist()


def test_the_first_trials_are_used_if_fewer_are_wanted(folder: Path) -> None:
    executed = read_trials(folder / "trials.parquet", allegro_space()).executed
    wanted = len(executed) - 5
    data = make_module(folder, trials=wanted)
    data.setup()
    used = {
        trial for part in (data.train, data.validation, data.test) for trial in part.trials.rows["trial_id"]
    }
    assert used == set(executed.rows["trial_id"][:wanted])
    with pytest.raises(InputError, match="executed ones"):
        make_module(folder, trials=len(executed) + 1).setup()


def test_every_grasp_comes_with_the_patch_of_its_own_scene(folder: Path) -> None:
    data = make_module(folder)
    data.setup()
    scene_ids = np.unique(data.test.trials.scene_ids).tolist()
    patches = dict(zip(scene_ids, data.test.patches(), strict=True))
    batches = list(data.test_dataloader())
    together = torch.cat([batch.view.patch for batch in batches])
    for patch, scene_id in zip(together, data.test.trials.scene_ids.tolist(), strict=True):
        assert torch.equal(patch, patches[scene_id])


def test_points_of_the_camera_frame_are_found_in_the_patch(folder: Path) -> None:
    data = make_module(folder)
    data.setup()
    scenes = read_scenes(folder / "scenes.parquet").by_id
    (view, *_), *_ = data.test_dataloader()
    scene_ids = data.test.trials.scene_ids.tolist()
    for scene_id, patch, numbers in zip(scene_ids, view.patch, view.intrinsics, strict=False):
        scene = scenes[scene_id]
        top = scene.T_world_object @ (0, 0, SIZES_M[scene.object_id][2] / 2 - 0.01, 1)
        x, y, depth, _ = np.linalg.inv(scene.camera.T_world_camera) @ top
        fx, fy, cx, cy = numbers.tolist()
        seen = patch[:3, round(fy * y / depth + cy), round(fx * x / depth + cx)]
        assert seen.tolist() == pytest.approx([200 / 255, 40 / 255, 40 / 255], abs=1e-3)


def test_further_data_sets_are_put_behind_the_first(folder: Path, tmp_path: Path) -> None:
    write_data_set(tmp_path, 4)
    both, first = make_module(folder, added=(tmp_path,)), make_module(folder)
    both.setup()
    first.setup()
    parts = (both.train, both.validation, both.test)
    executed = [
        read_trials(place / "trials.parquet", allegro_space()).executed for place in (folder, tmp_path)
    ]
    assert sum(map(len, parts)) == sum(map(len, executed))
    assert len({trial for part in parts for trial in part.trials.rows["trial_id"]}) == sum(map(len, parts))
    assert both.data_hash != first.data_hash
    assert len(next(iter(both.test_dataloader())).label)


def test_views_may_come_without_patches(folder: Path) -> None:
    data = make_module(folder)
    data.setup()
    batch, *_ = data.test_dataloader()
    data.render(with_patches=False)
    without, *_ = data.test_dataloader()
    assert without.view.patch.shape == (len(batch.label), 8, 0, 0)
    assert all(torch.equal(one, other) for one, other in zip(without.view[1:], batch.view[1:], strict=True))


def test_soft_labels_are_learned_from_and_not_tested_with(folder: Path, tmp_path: Path) -> None:
    table = read_trials(folder / TRIALS_FILE, allegro_space())
    soft = np.where(np.arange(len(table)) % 2, np.nan, 0.6)
    shutil.copy(folder / SCENES_FILE, tmp_path)
    write_trials(tmp_path / TRIALS_FILE, replace(table, rows=table.rows.assign(soft_label=soft)))
    data = make_module(tmp_path, soft_labels=True)
    data.setup()
    known = data.train.trials.soft_labels
    expected = np.where(np.isnan(known), data.train.trials.lifted, known)
    assert 0 < np.isnan(known).sum() < len(known)
    assert data.train.labels.numpy() == pytest.approx(expected)
    assert data.test.labels.bool().tolist() == data.test.trials.lifted.tolist()


def test_soft_labels_that_no_trial_has_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"collect\.repeats"):
        make_module(folder, soft_labels=True).setup()


def test_a_table_collected_with_something_else_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"camera=kinect.*camera=perfect"):
        make_module(folder, TableOrigin("lbr4_allegro", "grocery", "perfect")).setup()
