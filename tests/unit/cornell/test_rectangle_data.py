"""Rectangles as examples: parts that share no image, views without NaN, variations that keep the label."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from synthetic_cornell import surface_points, write_cornell

from preshape.cornell.augmentation import Augmentation, is_background
from preshape.cornell.data_module import AugmentedBatchSettings, CornellDataModule
from preshape.cornell.data_set import read_cornell
from preshape.cornell.object_finder import centre_of, find_object
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_views import RectangleViewSettings, rectangle_batch, rectangle_view
from preshape.cornell.view_store import ViewStore
from preshape.cornell.views import load_cornell_view
from preshape.data.folds import HoldOut
from preshape.errors import InputError
from preshape.geometry.pose import invert_pose, transform_points
from preshape.grasps.rectangle_space import rectangle_of, rectangle_space
from preshape.perception.gripper_frame import GripperFrame
from preshape.perception.image import DEPTH
from preshape.perception.observation import Observation

SPACE = rectangle_space("rectangle4")
EVERYTHING = Augmentation(
    mirrored=True, half_turned=True, shift_px=3.0, turn_rad=0.08, opening=0.05, light=0.1, background=0.5
)


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cornell(tmp_path_factory.mktemp("cornell"), n=6, cloud=False)


@pytest.fixture(scope="module")
def observation(root: Path) -> Observation:
    return load_cornell_view(read_cornell(root).images[0].files).observation


def make_data(
    root: Path,
    split: str = "unseen",
    fold: int = 0,
    validation: float = 0.0,
    augmentation: Augmentation = EVERYTHING,
) -> CornellDataModule:
    return CornellDataModule(
        root=root,
        space=SPACE,
        views=ViewStore(root / "views", RectangleViewSettings(step_px=4)),
        hold_out=HoldOut(split, fold=fold, validation_fraction=validation, seed=0),
        batches=AugmentedBatchSettings(4, 0, 3, 0, augmentation),
    )


@pytest.mark.parametrize("split", ["scenes", "unseen"])
def test_parts_share_no_image_and_every_image_is_tested_once(root: Path, split: str) -> None:
    tested: list[int] = []
    for fold in range(5):
        data = make_data(root, split, fold, validation=0.25)
        data.setup()
        parts = [set(part.trials.scene_ids.tolist()) for part in (data.train, data.validation, data.test)]
        assert all(parts)
        assert len(set.union(*parts)) == sum(map(len, parts))
        assert {image.files.number for image in data.test_images} == parts[2]
        tested += parts[2]
    assert sorted(tested) == list(range(100, 106))


def test_other_splits_are_refused(root: Path) -> None:
    with pytest.raises(InputError, match=r"split=scenes \(image-wise\)"):
        make_data(root, "seen").setup()


def test_a_training_batch_keeps_its_labels_and_its_seed_decides_it(root: Path) -> None:
    data = make_data(root)
    data.setup()
    data.render(with_patches=True)
    loader = data.train_dataloader()
    batches = list(loader)
    assert len(batches) == 3
    rows = next(iter(data.training_batches())).rows
    first = batches[0]
    assert len(first.theta) == 4 + 2
    assert torch.equal(first.label[:4], data.train.labels[rows])
    assert not first.label[4:].any()
    assert first.view.patch.isfinite().all()
    for one, again in zip(first.view, next(iter(loader)).view, strict=True):
        assert torch.equal(one, again)
    loader.sampler.begin_epoch(1)
    assert not torch.equal(next(iter(loader)).theta, first.theta)


def test_without_variations_a_batch_is_what_was_labelled(root: Path) -> None:
    data = make_data(root, augmentation=Augmentation(mirrored=False))
    data.setup()
    data.render(with_patches=True)
    drawn = next(iter(data.training_batches()))
    batch, plain = data.train[drawn], data.train[drawn.rows]
    assert torch.equal(batch.theta, plain.theta)
    assert torch.equal(batch.view.patch, plain.view.patch)


def test_background_is_far_from_what_is_positive() -> None:
    positives = [GraspRectangle(300.0, 200.0, 0.3, 40.0, 20.0), GraspRectangle(340.0, 220.0, 1.5, 30.0, 25.0)]
    rng = np.random.default_rng(0)
    drawn = [EVERYTHING.drawn_background(positives, rng) for _ in range(20)]
    rectangles = [rectangle_of(theta) for theta in drawn if theta is not None]
    assert len(rectangles) == 20
    assert all(is_background(own, positives) for own in rectangles)
    assert not is_background(replace(positives[0], u=303.0, angle_rad=0.2), positives)


def test_views_have_no_nan_and_average_what_is_known(observation: Observation) -> None:
    holes = observation.depth.copy()
    holes[:, 300:303] = np.nan
    holes[100:140, 100:140] = np.nan
    image = rectangle_view(replace(observation, depth=holes), RectangleViewSettings(step_px=4)).image
    assert image.shape == (8, 120, 160)
    assert np.isfinite(image).all()
    assert not image[DEPTH, 27:33, 27:33].any()
    assert image[DEPTH, 60, 75] == pytest.approx(np.nanmean(holes[240:244, 300:304]), abs=1e-3)


def test_a_view_without_a_table_has_a_plane_that_it_looks_at(observation: Observation) -> None:
    nothing = replace(observation, depth=np.full_like(observation.depth, np.nan))
    view = rectangle_view(nothing, RectangleViewSettings(step_px=4))
    assert GripperFrame(0.5).without_holes(rectangle_batch([view])).patch.isfinite().all()


def test_a_damaged_file_of_a_view_is_made_anew(root: Path, tmp_path: Path) -> None:
    files = read_cornell(root).images[0].files
    store = ViewStore(tmp_path, RectangleViewSettings(step_px=4))
    view = store.view(files)
    (path,) = tmp_path.rglob("*.npz")
    for content in (b"", b"PK nothing", path.read_bytes()[:-50], path.read_bytes()[:400]):
        path.write_bytes(content)
        again = store.view(files)
        assert all(np.array_equal(one, other) for one, other in zip(view, again, strict=True))


def test_a_step_that_does_not_divide_the_image_is_refused(observation: Observation) -> None:
    with pytest.raises(InputError, match="averaged over 7"):
        rectangle_view(observation, RectangleViewSettings(step_px=7))


def bare_table(observation: Observation) -> np.ndarray:
    """Depth of the view without the block."""
    points = surface_points(observation.camera, block_m=0.0)
    depth = transform_points(invert_pose(observation.camera.T_world_camera), points)[..., 2]
    return np.asarray(depth, dtype=np.float32)


@pytest.mark.parametrize("hidden", [(), ("depth",), ("colour",)])
def test_the_object_is_found_by_height_or_by_colour(observation: Observation, hidden: Sequence[str]) -> None:
    depth = bare_table(observation) if "depth" in hidden else observation.depth  # as flat as a pen
    rgb = np.full_like(observation.rgb, 220) if "colour" in hidden else observation.rgb
    mask = find_object(replace(observation, depth=depth, rgb=rgb))
    u, v = centre_of(mask)
    assert np.hypot(u - 319.5, v - 269.5) < 12


def test_a_bare_table_is_refused(observation: Observation) -> None:
    rgb = np.full_like(observation.rgb, 220)
    with pytest.raises(InputError, match="No object lies on the table"):
        find_object(replace(observation, depth=bare_table(observation), rgb=rgb))
