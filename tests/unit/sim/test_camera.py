"""SAPIEN's camera sees what the project's camera projects."""

import numpy as np
import pytest
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeBox, RenderShapeSphere

from preshape.geometry.camera import Camera
from preshape.geometry.pose import transform_points
from sim.camera import add_camera, camera_looking_at, colour, depth, segmentation, take_colour, take_picture
from sim.scene_systems import make_render_system

RADIUS_M = 0.01


def kinect() -> Camera:
    return camera_looking_at([0.8, -0.9, 1.25], [0.8, 0, 0.65], 640, 480, 525)


def crooked() -> Camera:
    """Neither square pixels nor a centred principal point."""
    pose = camera_looking_at([0.4, -0.7, 1.1], [0.8, 0.1, 0.7], 640, 480, 525).T_world_camera
    return Camera(640, 480, 500.0, 560.0, 300.0, 260.0, pose)


def add_ball(scene: sapien.Scene, centre: np.ndarray, rgb: tuple[float, float, float]) -> sapien.Entity:
    body = RenderBodyComponent()
    body.attach(RenderShapeSphere(RADIUS_M, RenderMaterial(base_color=[*rgb, 1.0])))
    entity = sapien.Entity()
    entity.add_component(body)
    entity.set_pose(sapien.Pose(centre))
    scene.add_entity(entity)
    return entity


def lit_scene() -> sapien.Scene:
    scene = sapien.Scene([make_render_system()])
    scene.set_ambient_light([1.0, 1.0, 1.0])
    return scene


@pytest.mark.parametrize("make_camera", [kinect, crooked])
def test_balls_appear_where_the_camera_projects_them(make_camera) -> None:
    camera, scene = make_camera(), lit_scene()
    centres = np.array([[0.8, 0.0, 0.65], [0.6, 0.1, 0.7], [0.95, -0.15, 0.62], [0.7, -0.2, 0.9]])
    balls = [add_ball(scene, centre, (1, 0, 0)) for centre in centres]
    lens = add_camera(scene, camera)
    take_picture(scene, lens)
    ids, distance, rgb = segmentation(lens), depth(lens), colour(lens)
    in_camera = transform_points(np.linalg.inv(camera.T_world_camera), centres)
    for ball, point in zip(balls, in_camera, strict=True):
        v, u = np.nonzero(ids == ball.per_scene_id)
        expected_u, expected_v = camera.project(point)
        # A ball's outline is not quite symmetric about the projection of its centre.
        assert (u.min() + u.max()) / 2 == pytest.approx(expected_u, abs=0.6)
        assert (v.min() + v.max()) / 2 == pytest.approx(expected_v, abs=0.6)
        front = distance[round(float(expected_v)), round(float(expected_u))]
        line_of_sight = point / np.linalg.norm(point)
        assert front == pytest.approx((point - RADIUS_M * line_of_sight)[2], abs=1e-3)
        red = rgb[round(float(expected_v)), round(float(expected_u))]
        assert red[0] > red[1] + 100


def test_depth_unprojects_to_a_plane_within_a_tenth_of_a_millimetre() -> None:
    camera, scene = kinect(), lit_scene()
    body = RenderBodyComponent()
    body.attach(RenderShapeBox([0.3, 0.4, 0.05], RenderMaterial()))
    slab = sapien.Entity()
    slab.add_component(body)
    slab.set_pose(sapien.Pose([0.8, 0.0, 0.54]))
    scene.add_entity(slab)
    lens = add_camera(scene, camera)
    take_picture(scene, lens)
    points = transform_points(camera.T_world_camera, camera.unproject(depth(lens)).reshape(-1, 3))
    seen = ~np.isnan(points[:, 0])
    on_top = seen & (points[:, 2] > 0.585) & (points[:, 1] > -0.399)  # not the side that faces us
    np.testing.assert_allclose(points[on_top, 2], 0.59, atol=1e-4)
    np.testing.assert_allclose(points[on_top, 0].min(), 0.5, atol=6e-3)
    np.testing.assert_allclose(points[on_top, 1].max(), 0.4, atol=6e-3)


def test_nothing_has_no_depth() -> None:
    scene = lit_scene()
    lens = add_camera(scene, kinect())
    assert take_colour(scene, lens).shape == (480, 640, 3)
    assert np.isnan(depth(lens)).all()


def test_the_robot_side_is_left_and_up_is_up() -> None:
    camera = kinect()
    towards_robot, above = np.array([0.7, 0, 0.65]), np.array([0.8, 0, 0.75])
    to_camera = np.linalg.inv(camera.T_world_camera)
    u, v = camera.project(transform_points(to_camera, np.stack((towards_robot, above))))
    assert u[0] < camera.cx
    assert v[1] < camera.cy
