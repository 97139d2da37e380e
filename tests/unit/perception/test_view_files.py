"""Saved views come back as they were; whatever else stands in the files ends in one InputError."""

import json
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from preshape.errors import InputError
from preshape.geometry.camera import Camera
from preshape.perception.observation import Observation
from preshape.perception.segmentation import SegmentationSettings, segment
from preshape.perception.view_files import CAMERA_NAME, DEPTH_NAME, RGB_NAME, load_view, save_view

NAMES = (RGB_NAME, DEPTH_NAME, CAMERA_NAME)
FUZZ = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda entries: st.lists(entries, max_size=4) | st.dictionaries(st.text(max_size=5), entries, max_size=3),
    max_leaves=20,
)


def small_view() -> Observation:
    rng = np.random.default_rng(0)
    depth = rng.uniform(0.5, 2.0, (12, 16)).astype(np.float32)
    depth[2, 3] = np.nan
    eye, target = np.array([0.8, -0.9, 1.2]), np.array([0.8, 0, 0.6])
    camera = Camera.looking_at(eye, target, width=16, height=12, focal=20.0)
    return Observation(rng.integers(0, 256, (12, 16, 3), dtype=np.uint8), depth, None, camera)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_view(tmp_path, small_view())
    return tmp_path


def load(folder: Path) -> Observation:
    return load_view(folder / RGB_NAME, folder / DEPTH_NAME, folder / CAMERA_NAME)


def test_depth_may_be_metres_or_millimetres_in_a_numpy_file(folder: Path) -> None:
    expected, path = load(folder).depth, folder / "depth.npy"
    for values in (expected, np.nan_to_num(expected * 1000).round().astype(np.uint16)):
        np.save(path, values)
        loaded = load_view(folder / RGB_NAME, path, folder / CAMERA_NAME)
        np.testing.assert_allclose(loaded.depth, expected, atol=1e-6)


@pytest.mark.parametrize(
    "values", [np.full((2, 2), 1.0), np.full((12, 16), "1"), np.array([{}]), None], ids=str
)
def test_a_numpy_file_of_something_else_is_refused(values: Any, folder: Path) -> None:
    path = folder / "depth.npy"
    if values is not None:
        np.save(path, values)
    with pytest.raises(InputError) as refusal:
        load_view(folder / RGB_NAME, path, folder / CAMERA_NAME)
    assert refusal.value.where == str(path)


def edit_camera(folder: Path, **changes: Any) -> None:
    """Change keys of the camera file; None takes a key away."""
    content = json.loads((folder / CAMERA_NAME).read_text()) | changes
    content = {key: value for key, value in content.items() if value is not None}
    (folder / CAMERA_NAME).write_text(json.dumps(content))


def test_view_comes_back(folder: Path) -> None:
    saved, loaded = small_view(), load(folder)
    np.testing.assert_array_equal(loaded.rgb, saved.rgb)
    np.testing.assert_allclose(loaded.depth, saved.depth, atol=0.0005 + 1e-6)
    np.testing.assert_array_equal(np.isnan(loaded.depth), np.isnan(saved.depth))
    assert loaded.depth.dtype == np.float32
    np.testing.assert_allclose(loaded.camera.T_world_camera, saved.camera.T_world_camera, atol=1e-12)
    for key in ("width", "height", "fx", "fy", "cx", "cy"):
        assert getattr(loaded.camera, key) == getattr(saved.camera, key)


def test_saving_leaves_three_files(folder: Path) -> None:
    assert {path.name for path in folder.iterdir()} == set(NAMES)


def test_depth_in_other_units(folder: Path) -> None:
    units = np.array(Image.open(folder / DEPTH_NAME)).astype(np.uint16) * 5
    Image.fromarray(units).save(folder / DEPTH_NAME)
    edit_camera(folder, depth_scale_m=0.0002)
    np.testing.assert_allclose(load(folder).depth, small_view().depth, atol=0.0006)


@pytest.mark.parametrize("name", NAMES)
def test_missing_file(folder: Path, name: str) -> None:
    (folder / name).unlink()
    with pytest.raises(InputError, match="does not exist") as caught:
        load(folder)
    assert caught.value.where.endswith(name)


@pytest.mark.parametrize("name", NAMES)
def test_folder_instead_of_a_file(folder: Path, name: str) -> None:
    (folder / name).unlink()
    (folder / name).mkdir()
    with pytest.raises(InputError):
        load(folder)


@pytest.mark.parametrize("name", [RGB_NAME, DEPTH_NAME])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9])
def test_truncated_image(folder: Path, name: str, share: float) -> None:
    content = (folder / name).read_bytes()
    (folder / name).write_bytes(content[: int(len(content) * share)])
    with pytest.raises(InputError, match="truncated") as caught:
        load(folder)
    assert caught.value.where.endswith(name)


@pytest.mark.parametrize("scale", [1.0, 0.1, 0.01, 0.00001])
def test_depth_in_the_wrong_unit(folder: Path, scale: float) -> None:
    edit_camera(folder, depth_scale_m=scale)
    with pytest.raises(InputError, match=r"outside of 0\.2-5 m"):
        load(folder)


def test_empty_depth(folder: Path) -> None:
    Image.fromarray(np.zeros((12, 16), dtype=np.uint16)).save(folder / DEPTH_NAME)
    with pytest.raises(InputError, match="saw nothing"):
        load(folder)


def test_swapped_colour_and_depth(folder: Path) -> None:
    with pytest.raises(InputError, match="swapped") as caught:
        load_view(folder / DEPTH_NAME, folder / RGB_NAME, folder / CAMERA_NAME)
    assert caught.value.where.endswith(DEPTH_NAME)
    with pytest.raises(InputError, match="swapped"):
        load_view(folder / RGB_NAME, folder / RGB_NAME, folder / CAMERA_NAME)


@pytest.mark.parametrize("name", [RGB_NAME, DEPTH_NAME])
def test_sizes_that_differ(folder: Path, name: str) -> None:
    image = np.array(Image.open(folder / name))
    Image.fromarray(image[:, :-1].copy()).save(folder / name)
    with pytest.raises(InputError, match="15 x 12 pixels, but the camera 16 x 12"):
        load(folder)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fx": None}, "lacks the key fx"),
        ({"depth_scale_m": None}, "lacks the key depth_scale_m"),
        ({"fx": 0}, "positive number for fx"),
        ({"fy": float("nan")}, "number for fy"),
        ({"cx": "8"}, "number for cx"),
        ({"cy": True}, "number for cy"),
        ({"fx": 10**400}, "number for fx"),
        ({"width": 16.5}, "whole number"),
        ({"width": 10**9}, "whole number"),
        ({"focal_length": 525}, "unknown keys: focal_length"),
        ({"T_world_camera": np.zeros((4, 4)).tolist()}, "T_world_camera"),
        ({"T_world_camera": np.diag([1.0, 1, -1, 1]).tolist()}, "T_world_camera"),
        ({"T_world_camera": np.eye(3).tolist()}, "T_world_camera"),
        ({"T_world_camera": [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]}, "T_world_camera"),
    ],
)
def test_bad_camera_file(folder: Path, changes: dict[str, Any], message: str) -> None:
    edit_camera(folder, **changes)
    with pytest.raises(InputError, match=message) as caught:
        load(folder)
    assert caught.value.where.endswith(CAMERA_NAME)


def test_pose_is_found_from_the_table(table_top: Any, tmp_path: Path) -> None:
    observation = table_top.view(table_top.box((0.1, 0.06, 0.2)), noise_seed=0)
    save_view(tmp_path, observation)
    edit_camera(tmp_path, T_world_camera=None)
    loaded = load(tmp_path)
    known, found = observation.camera.T_world_camera, loaded.camera.T_world_camera
    np.testing.assert_allclose(found[:3, :3], known[:3, :3], atol=0.005)
    assert abs(found[2, 3] - (known[2, 3] - table_top.height_m)) < 0.003
    assert segment(loaded, SegmentationSettings()).mask.sum() > 1000


def test_view_without_object(table_top: Any, tmp_path: Path) -> None:
    save_view(tmp_path, table_top.view(noise_seed=0))
    with pytest.raises(InputError, match="No object"):
        segment(load(tmp_path), SegmentationSettings())


def test_save_to_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        save_view(tmp_path / "file" / "view", small_view())


@pytest.fixture
def pristine(folder: Path) -> dict[str, bytes]:
    """Content of the three files, to start each fuzzed example from."""
    return {name: (folder / name).read_bytes() for name in NAMES}


def load_damaged(folder: Path, files: dict[str, bytes]) -> Observation | None:
    """The view in files of this content, or None if it is refused."""
    for name, content in files.items():
        (folder / name).write_bytes(content)
    try:
        return load(folder)
    except InputError:
        return None


@FUZZ
@given(name=st.sampled_from(NAMES), content=st.binary(max_size=400))
def test_any_bytes_are_refused(folder: Path, pristine: dict[str, bytes], name: str, content: bytes) -> None:
    assert load_damaged(folder, pristine | {name: content}) is None


@FUZZ
@given(data=st.data(), name=st.sampled_from(NAMES))
def test_damage_is_refused_or_harmless(
    folder: Path, pristine: dict[str, bytes], name: str, data: st.DataObject
) -> None:
    content = bytearray(pristine[name])
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    content = content[: data.draw(st.integers(1, len(content)))]
    loaded = load_damaged(folder, pristine | {name: bytes(content)})
    if loaded is not None:
        assert loaded.rgb.shape == (12, 16, 3)
        assert np.isfinite(loaded.camera.T_world_camera).all()
        assert not (loaded.depth <= 0).any()


@FUZZ
@given(data=st.data(), name=st.sampled_from([RGB_NAME, DEPTH_NAME]))
def test_damage_with_right_checksums_is_refused_or_harmless(
    folder: Path, pristine: dict[str, bytes], name: str, data: st.DataObject
) -> None:
    """A chunk of the PNG is changed and given its checksum, so that the decoder goes on to its content."""
    png = pristine[name]
    start = data.draw(st.sampled_from([png.index(kind) for kind in (b"IHDR", b"IDAT")]))
    (length,) = struct.unpack(">I", png[start - 4 : start])
    chunk = bytearray(png[start : start + 4 + length])
    for _ in range(data.draw(st.integers(1, 3))):
        chunk[data.draw(st.integers(4, len(chunk) - 1))] = data.draw(st.integers(0, 255))
    checksum = struct.pack(">I", zlib.crc32(chunk))
    damaged = png[:start] + bytes(chunk) + checksum + png[start + 8 + length :]
    loaded = load_damaged(folder, pristine | {name: damaged})
    assert loaded is None or loaded.rgb.shape[:2] == loaded.depth.shape == (12, 16)


@FUZZ
@given(key=st.sampled_from(["width", "fx", "cx", "depth_scale_m", "T_world_camera"]), value=json_values)
def test_any_value_in_the_camera_file_is_refused_or_sound(
    folder: Path, pristine: dict[str, bytes], key: str, value: Any
) -> None:
    camera = json.dumps(json.loads(pristine[CAMERA_NAME]) | {key: value})
    loaded = load_damaged(folder, pristine | {CAMERA_NAME: camera.encode()})
    assert loaded is None or np.isfinite([loaded.camera.fx, loaded.camera.cx]).all()
