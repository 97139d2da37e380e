import numpy as np
import pytest
from synthetic_scenes import BoxRenderer, allegro_space, make_scene

from preshape.data.trial import Face
from preshape.drawing.grasp_window import cut, grasp_window
from preshape.drawing.plan_picture import plan_picture
from preshape.hands.allegro import allegro_hand
from preshape.planning.bounds import Bounds, BoxSize
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.heuristic import HeuristicPlanner
from preshape.planning.objective import UnknownSuccess

SCENE = make_scene(0)


def theta(u: float, v: float, distance_m: float) -> np.ndarray:
    """A grasp whose palm projects to pixel (u, v)."""
    camera = SCENE.camera
    ray = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    return np.concatenate((distance_m * ray, np.zeros(11)))


@pytest.mark.parametrize("pixel", [(160, 120), (0, 0), (319, 239), (-500, 90)])
def test_window_stays_in_the_view_and_holds_the_palm_if_it_is_there(pixel: tuple[int, int]) -> None:
    rows, columns = grasp_window(SCENE.camera, np.stack([theta(*pixel, 1.0)] * 2))
    assert 0 <= rows.start < rows.stop <= 240
    assert 0 <= columns.start < columns.stop <= 320
    if pixel[0] >= 0:
        assert columns.start <= pixel[0] <= columns.stop
        assert rows.start <= pixel[1] <= rows.stop


def test_window_shows_the_same_metres_at_any_distance() -> None:
    widths = [len(range(320)[grasp_window(SCENE.camera, theta(160, 120, z)[None])[1]]) for z in (1.0, 2.0)]
    assert widths[0] == pytest.approx(2 * widths[1], abs=1)


def test_cut_follows_the_scale_of_the_picture() -> None:
    picture = np.zeros((480, 640, 3), dtype=np.uint8)
    assert cut(picture, (slice(10, 30), slice(5, 105)), scale=2).shape == (40, 200, 3)


def test_every_grasp_has_its_panel_and_says_what_is_known() -> None:
    initial = np.stack([theta(160, 110, 1.1), theta(150, 120, 1.1)])
    bounds = Bounds.around(initial, allegro_space(), BoxSize())
    result = HeuristicPlanner().plan(UnknownSuccess(), initial, bounds)
    faces = (Face.TOP, Face.SIDE_NEAREST)
    plan = GraspPlan("heuristic", allegro_space(), faces, result, SCENE.camera.T_world_camera, np.eye(4))
    figure = plan_picture(BoxRenderer()(SCENE), plan, allegro_hand())
    assert [axes.get_title() for axes in figure.axes] == [
        "1. top: success unknown",
        "2. side nearest: success unknown",
    ]
