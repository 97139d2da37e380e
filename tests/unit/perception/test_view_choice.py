from pathlib import Path

import numpy as np
import pytest
from synthetic_scenes import BoxRenderer, make_scene

from preshape.errors import InputError
from preshape.perception.view_choice import load_chosen_view
from preshape.perception.view_files import CAMERA_NAME, DEPTH_NAME, RGB_NAME, save_view


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("view")
    save_view(folder, BoxRenderer()(make_scene(0)))
    return folder


def test_a_folder_and_its_files_give_the_same_view(folder: Path) -> None:
    by_folder = load_chosen_view(folder)
    by_files = load_chosen_view(None, folder / RGB_NAME, folder / DEPTH_NAME, folder / CAMERA_NAME)
    np.testing.assert_array_equal(by_folder.depth, by_files.depth)
    np.testing.assert_array_equal(by_folder.rgb, by_files.rgb)


def test_a_file_replaces_that_of_the_folder(folder: Path, tmp_path: Path) -> None:
    save_view(tmp_path, BoxRenderer()(make_scene(1)))
    mixed = load_chosen_view(folder, depth_file=tmp_path / DEPTH_NAME)
    np.testing.assert_array_equal(mixed.rgb, load_chosen_view(folder).rgb)
    np.testing.assert_array_equal(mixed.depth, load_chosen_view(tmp_path).depth)


def test_what_is_missing_is_named(folder: Path) -> None:
    with pytest.raises(InputError, match="No view was given"):
        load_chosen_view()
    with pytest.raises(InputError, match="depth_file, camera_file not set"):
        load_chosen_view(rgb_file=folder / RGB_NAME)
    with pytest.raises(InputError, match="folder of the view does not exist"):
        load_chosen_view(folder / "nowhere")
