"""Captures in BigBIRD's own layout become views whose colour, depth, mask and camera agree."""

import pickle
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from PIL import Image
from synthetic_bigbird import BOX_CENTRE, BOX_SIZE, RED, SENSOR, write_capture, write_hdf5

from preshape.errors import InputError
from preshape.geometry.pose import invert_pose, transform_points
from preshape.perception.bigbird_views import load_bigbird_view
from preshape.perception.depth_registration import DEPTH_STEP_M
from preshape.perception.hdf5_files import read_hdf5
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.perception.view_choice import load_chosen_view
from preshape.perception.view_files import save_view

ANGLE = 30
CAPTURE = f"NP{SENSOR}_{ANGLE}"
FILES = (
    *(f"{CAPTURE}.jpg", f"{CAPTURE}.h5", f"masks/{CAPTURE}_mask.pbm"),
    *("calibration.h5", f"poses/NP5_{ANGLE}_pose.h5"),
)
HDF5_FILES = [name for name in FILES if name.endswith(".h5")]


@pytest.fixture(scope="module")
def captured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bigbird") / "red_box"
    write_capture(folder, ANGLE)
    return folder


@pytest.fixture(scope="module")
def view(captured: Path) -> Observation:
    return load_bigbird_view(captured, SENSOR, ANGLE, width=320)


@pytest.fixture
def folder(captured: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(captured, tmp_path / "red_box"))


def world_points(view: Observation) -> np.ndarray:
    return transform_points(view.camera.T_world_camera, view.camera.unproject(view.depth.astype(np.float64)))


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    return np.count_nonzero(one & other) / np.count_nonzero(one | other)


class TestRegistration:
    def test_the_view_has_the_proportions_of_the_colour_image(self, view: Observation) -> None:
        assert view.rgb.shape == (256, 320, 3)
        assert view.depth.shape == (256, 320)
        assert (view.camera.width, view.camera.height) == (320, 256)

    def test_every_measured_point_lies_on_the_scene(self, view: Observation) -> None:
        points = world_points(view)[np.isfinite(view.depth)]
        assert len(points) > 0.2 * view.depth.size
        outside = np.maximum(np.abs(points - BOX_CENTRE) - BOX_SIZE / 2, 0)
        to_box = np.linalg.norm(outside, axis=1)
        to_scene = np.minimum(to_box, np.abs(points[:, 2]))
        assert np.quantile(to_scene, 0.95) < 0.001
        assert to_scene.max() < DEPTH_STEP_M

    def test_a_known_point_is_where_the_camera_puts_it(self, view: Observation) -> None:
        assert view.mask is not None
        signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
        corners = transform_points(invert_pose(view.camera.T_world_camera), BOX_CENTRE + signs * BOX_SIZE)
        rows, columns = np.nonzero(view.mask)
        for found, expected in zip((columns, rows), view.camera.project(corners), strict=True):
            assert found.min() - 0.5 == pytest.approx(expected.min(), abs=1)
            assert found.max() + 0.5 == pytest.approx(expected.max(), abs=1)
        corner = corners[np.argmin(corners[:, 2])]  # the nearest one
        u, v = (round(float(pixel)) for pixel in view.camera.project(corner))
        around = view.depth[v - 1 : v + 2, u - 1 : u + 2]
        assert np.nanmin(around) == pytest.approx(corner[2], abs=0.003)

    def test_colour_depth_and_mask_show_the_same_object(self, view: Observation) -> None:
        assert view.mask is not None
        red = np.abs(view.rgb.astype(int) - RED).max(axis=-1) < 40
        assert overlap(red, view.mask) > 0.95
        raised = np.nan_to_num(world_points(view)[..., 2]) > 0.005
        assert overlap(raised, view.mask) > 0.9
        assert np.isfinite(view.depth[view.mask]).mean() > 0.9

    def test_segmentation_finds_the_object_of_the_mask(self, view: Observation) -> None:
        assert view.mask is not None
        assert overlap(segment(view, SegmentationSettings()).mask, view.mask) > 0.85

    def test_a_wider_view_shows_the_same(self, captured: Path, view: Observation) -> None:
        wide = load_bigbird_view(captured, SENSOR, ANGLE, width=640)
        assert wide.rgb.shape == (512, 640, 3)
        gap = np.nanmedian(np.abs(wide.depth.reshape(256, 2, 320, 2).mean(axis=(1, 3)) - view.depth))
        assert gap < 0.0005
        # twice as many pixels as the sensor has, and no gaps between its points
        assert np.isfinite(wide.depth).mean() == pytest.approx(np.isfinite(view.depth).mean(), abs=0.02)

    def test_the_object_stays_in_place_while_the_turntable_turns(self, tmp_path: Path) -> None:
        write_capture(tmp_path, 0)
        points = world_points(load_bigbird_view(tmp_path, SENSOR, 0, width=320))
        top = points[np.abs(points[..., 2] - BOX_SIZE[2]) < 0.001]
        np.testing.assert_allclose((top.min(axis=0) + top.max(axis=0))[:2] / 2, BOX_CENTRE[:2], atol=0.003)

    def test_the_world_is_turned_up_where_the_files_count_downwards(self, folder: Path) -> None:
        write_capture(folder, ANGLE, upside_down=True)
        turned = load_bigbird_view(folder, SENSOR, ANGLE, width=320)
        assert turned.camera.T_world_camera[2, 3] > 0
        heights = world_points(turned)[..., 2]
        assert np.nanmin(heights) > -0.01
        assert np.nanmax(heights) == pytest.approx(BOX_SIZE[2], abs=0.003)

    def test_files_may_lie_under_processed(self, folder: Path, view: Observation) -> None:
        (folder / "processed").mkdir()
        for name in ("masks", "poses"):
            (folder / name).rename(folder / "processed" / name)
        moved = load_bigbird_view(folder, SENSOR, ANGLE, width=320)
        np.testing.assert_array_equal(moved.depth, view.depth)
        np.testing.assert_array_equal(moved.mask, view.mask)

    def test_a_view_is_saved_for_the_plan_command(self, view: Observation, tmp_path: Path) -> None:
        save_view(tmp_path / "view", view)
        again = load_chosen_view(tmp_path / "view")
        np.testing.assert_array_equal(again.rgb, view.rgb)
        np.testing.assert_allclose(again.depth, view.depth, atol=0.00051)


class TestMask:
    @pytest.mark.parametrize("bright", [True, False])
    def test_the_object_is_the_smaller_part(self, folder: Path, view: Observation, bright: bool) -> None:
        write_capture(folder, ANGLE, bright_object=bright)
        np.testing.assert_array_equal(load_bigbird_view(folder, SENSOR, ANGLE, width=320).mask, view.mask)

    def test_a_capture_without_mask_is_a_view_without_mask(self, folder: Path, view: Observation) -> None:
        (folder / FILES[2]).unlink()
        unmasked = load_bigbird_view(folder, SENSOR, ANGLE, width=320)
        assert unmasked.mask is None
        np.testing.assert_array_equal(unmasked.rgb, view.rgb)

    def test_an_empty_mask_is_none(self, folder: Path) -> None:
        Image.new("1", (640, 512), 1).save(folder / FILES[2])
        assert load_bigbird_view(folder, SENSOR, ANGLE).mask is None

    def test_a_mask_of_another_size_is_refused(self, folder: Path) -> None:
        Image.new("1", (64, 51), 1).save(folder / FILES[2])
        with pytest.raises(InputError, match="64 x 51"):
            load_bigbird_view(folder, SENSOR, ANGLE)


class TestBadInput:
    @pytest.mark.parametrize("keep", [0.0, 0.3, 0.9])
    @pytest.mark.parametrize("name", FILES)
    def test_every_truncated_file_is_named(self, folder: Path, name: str, keep: float) -> None:
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: int(keep * len(content))])
        with pytest.raises(InputError) as error:
            load_bigbird_view(folder, SENSOR, ANGLE)
        assert error.value.where == str(folder / name)

    @pytest.mark.parametrize("name", [name for name in FILES if "mask" not in name])
    def test_every_missing_file_is_named(self, folder: Path, name: str) -> None:
        (folder / name).unlink()
        with pytest.raises(InputError, match=rf"lacks {name}[\s\S]*rll.berkeley.edu/bigbird"):
            load_bigbird_view(folder, SENSOR, ANGLE)

    @pytest.mark.parametrize("name", HDF5_FILES)
    def test_a_pickle_is_not_opened(self, folder: Path, name: str) -> None:
        (folder / name).write_bytes(pickle.dumps({"depth": np.zeros((2, 2))}))
        with pytest.raises(InputError, match="not HDF5"):
            load_bigbird_view(folder, SENSOR, ANGLE)

    @pytest.mark.parametrize(("sensor", "angle"), [(0, 0), (6, 0), (3, 1), (3, 360), (3, -3)])
    def test_a_capture_that_bigbird_has_not(self, folder: Path, sensor: int, angle: int) -> None:
        with pytest.raises(InputError, match="no capture"):
            load_bigbird_view(folder, sensor, angle)

    def test_a_missing_folder(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="does not exist"):
            load_bigbird_view(tmp_path / "nowhere", SENSOR, ANGLE)

    @pytest.mark.parametrize("width", [0, 641])
    def test_a_width_that_the_image_has_not(self, folder: Path, width: int) -> None:
        with pytest.raises(InputError, match="640 pixels"):
            load_bigbird_view(folder, SENSOR, ANGLE, width=width)

    @pytest.mark.parametrize(
        ("key", "value", "complaint"),
        [
            (f"NP{SENSOR}_rgb_K", np.zeros((3, 3)), "camera matrix"),
            (f"NP{SENSOR}_depth_K", np.full((3, 3), np.nan), "camera matrix"),
            (f"NP{SENSOR}_depth_K", np.eye(4), "shape"),
            (f"NP{SENSOR}_ir_depth_scale", np.zeros(1), "not positive"),
            (f"NP{SENSOR}_rgb_d", np.full(5, np.inf), "not finite"),
            (f"H_NP{SENSOR}_from_NP5", np.ones((4, 4)), "no pose"),
            (f"H_NP{SENSOR}_ir_from_NP5", None, "lacks"),
        ],
    )
    def test_a_calibration_that_is_none(
        self, folder: Path, key: str, value: np.ndarray | None, complaint: str
    ) -> None:
        with h5py.File(folder / "calibration.h5", "a") as file:
            del file[key]
            if value is not None:
                file[key] = value
        with pytest.raises(InputError, match=complaint):
            load_bigbird_view(folder, SENSOR, ANGLE)


def write_object(file: h5py.File, elsewhere: Path) -> None:
    file.create_dataset("depth", (2, 2), dtype=h5py.string_dtype())


def write_reference(file: h5py.File, elsewhere: Path) -> None:
    file.create_dataset("depth", (2, 2), dtype=h5py.ref_dtype)


def write_opaque(file: h5py.File, elsewhere: Path) -> None:
    file["depth"] = np.full((2, 2), np.void(pickle.dumps(1)))


def write_group(file: h5py.File, elsewhere: Path) -> None:
    file.create_group("depth")


def write_external_link(file: h5py.File, elsewhere: Path) -> None:
    file["depth"] = h5py.ExternalLink(elsewhere, "depth")


def write_external_storage(file: h5py.File, elsewhere: Path) -> None:
    file.create_dataset("depth", (2, 2), dtype="u1", external=[(elsewhere, 0, 4)])


def write_virtual(file: h5py.File, elsewhere: Path) -> None:
    layout = h5py.VirtualLayout((2, 2), "u2")
    layout[:] = h5py.VirtualSource(elsewhere, "depth", (2, 2))
    file.create_virtual_dataset("depth", layout)


def write_huge(file: h5py.File, elsewhere: Path) -> None:
    file.create_dataset("depth", (2**20, 2**20), dtype="u2", chunks=(64, 64))


@pytest.mark.parametrize(
    "write",
    [
        *(write_object, write_reference, write_opaque, write_group),
        *(write_external_link, write_external_storage, write_virtual, write_huge),
    ],
)
def test_only_plain_arrays_in_the_file_itself_are_read(
    tmp_path: Path, write: Callable[[h5py.File, Path], None]
) -> None:
    write_hdf5(tmp_path / "elsewhere.h5", depth=np.ones((2, 2), np.uint16))
    with h5py.File(tmp_path / "depth.h5", "w") as file:
        write(file, tmp_path / "elsewhere.h5")
    with pytest.raises(InputError, match=r"depth\.h5"):
        read_hdf5(tmp_path / "depth.h5", {"depth": (None, None)})
