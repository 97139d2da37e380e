"""Grasps are drawn where they project to, in colours that are told apart; pictures are written whole."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from preshape.cornell.rectangle import GraspRectangle
from preshape.drawing.canvas import INITIAL_STYLE, PLANNED_STYLE
from preshape.drawing.channel_grid import channel_grid
from preshape.drawing.grasp_overlay import grasp_overlay, rectangle_overlay
from preshape.drawing.picture_files import save_picture
from preshape.errors import InputError
from preshape.geometry.pose import invert_pose, make_pose
from preshape.grasps.space import GraspSpace
from preshape.hands.allegro import allegro_hand
from preshape.perception.image import CHANNEL_NAMES, eight_channel_image

HAND = allegro_hand()
SPACE = GraspSpace.palm_and_joints("test", {f"joint_{k}": (-1.0, 1.0) for k in range(8)})
GREY = np.full((480, 640, 3), 128, dtype=np.uint8)


def side_grasp(table_top: Any, x: float = 0.8) -> np.ndarray:
    """Palm before the table's centre, looking along the world's +y, thumb up."""
    rotation = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    palm = make_pose(rotation, np.array([x, -0.1, 0.75]))
    return SPACE.theta(invert_pose(table_top.camera.T_world_camera) @ palm, np.zeros(8))


def colour_share(picture: np.ndarray, pixel: np.ndarray, colour: tuple[int, int, int]) -> float:
    """Share of pixels of about that colour around a pixel of the view, in a picture of twice its size."""
    u, v = np.round(pixel * 2).astype(int)
    near = picture[v - 6 : v + 7, u - 6 : u + 7].astype(int)
    return float((np.abs(near - colour).max(axis=-1) < 40).mean())


def test_joints_are_drawn_where_they_project_to(table_top: Any) -> None:
    theta = side_grasp(table_top)
    for name, style in (("initial", INITIAL_STYLE), ("planned", PLANNED_STYLE)):
        picture = grasp_overlay(GREY, table_top.camera, HAND, **{name: theta})
        assert picture.shape == (960, 1280, 3)
        for tip in HAND.fingertips(torch.tensor(theta)[None])[0].numpy():
            assert colour_share(picture, np.array(table_top.camera.project(tip)), style.colour) > 0.1


def test_initial_and_planned_are_both_seen(table_top: Any) -> None:
    first, second = side_grasp(table_top, x=0.6), side_grasp(table_top, x=0.95)
    picture = grasp_overlay(GREY, table_top.camera, HAND, initial=first, planned=second)
    for theta, style in ((first, INITIAL_STYLE), (second, PLANNED_STYLE)):
        index = HAND.fingertips(torch.tensor(theta)[None])[0, 0].numpy()
        assert colour_share(picture, np.array(table_top.camera.project(index)), style.colour) > 0.1


def test_the_rest_of_the_view_stays(table_top: Any) -> None:
    picture = grasp_overlay(GREY, table_top.camera, HAND, planned=side_grasp(table_top), scale=1)
    assert picture.shape == GREY.shape
    assert (picture[:100] == 128).all()
    np.testing.assert_array_equal(grasp_overlay(GREY, table_top.camera, HAND, scale=1), GREY)


def test_rectangles_are_drawn_around_their_centre_with_jaws_at_both_ends() -> None:
    level = GraspRectangle(320.0, 240.0, 0.0, 60.0, 25.0)
    picture = rectangle_overlay(GREY, planned=level, scale=1)[:400].astype(int)
    drawn = np.abs(picture - 128).max(axis=-1) > 20
    np.testing.assert_allclose(np.argwhere(drawn).mean(axis=0), (240, 320), atol=1)
    assert not drawn[232:249, 295:346].any()
    blue = picture[..., 2] - picture[..., 0] > 60
    assert blue[230:251, 286:292].all()
    assert blue[230:251, 349:355].all()
    np.testing.assert_array_equal(rectangle_overlay(GREY, scale=1), GREY)


def test_grasps_out_of_view_do_no_harm(table_top: Any) -> None:
    behind = side_grasp(table_top)
    behind[2] = -1.0
    for theta in (behind, np.full(14, np.nan), side_grasp(table_top, x=1.6)):
        grasp_overlay(GREY, table_top.camera, HAND, initial=theta, planned=theta)


def test_grid_names_every_channel(table_top: Any) -> None:
    image = eight_channel_image(table_top.view(table_top.box((0.1, 0.06, 0.2)), noise_seed=0))
    titles = [axes.get_title() for axes in channel_grid(image).axes]
    assert [title for title in titles if title] == [name.replace("_", " ") for name in CHANNEL_NAMES]
    channel_grid(np.zeros_like(image))


def test_pictures_are_written(tmp_path: Path) -> None:
    picture = np.random.default_rng(0).integers(0, 256, (12, 16, 3), dtype=np.uint8)
    save_picture(tmp_path / "made" / "picture.png", picture)
    np.testing.assert_array_equal(np.array(Image.open(tmp_path / "made" / "picture.png")), picture)
    save_picture(tmp_path / "grid.png", channel_grid(np.ones((8, 20, 20), dtype=np.float32)))
    assert Image.open(tmp_path / "grid.png").size[0] == 1200
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError):
        save_picture(tmp_path / "file" / "picture.png", picture)
