"""Solids, their convex parts, their normals and which way up they stand."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from preshape.geometry.pose import make_pose
from sim.objects.colour import colour_from_hex, linear_rgb
from sim.objects.loft import Station, convex_parts
from sim.objects.object_model import ObjectModel, volume_and_centroid
from sim.objects.resting_pose import stood_up
from sim.objects.shading import crease_normals, painted_part


def model_of(*meshes: trimesh.Trimesh) -> ObjectModel:
    return ObjectModel("solid", tuple(np.array(mesh.vertices) for mesh in meshes), (), 1.0, 1.0).centred()


def test_volume_and_centroid_of_known_solids() -> None:
    cube = trimesh.creation.box((0.1, 0.2, 0.3))
    pyramid = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3.0]]) + 7
    volume, centroid = volume_and_centroid([np.array(cube.vertices)])
    assert volume == pytest.approx(0.006)
    np.testing.assert_allclose(centroid, 0, atol=1e-12)
    volume, centroid = volume_and_centroid([pyramid])
    assert volume == pytest.approx(4.5)
    np.testing.assert_allclose(centroid, 7.75)


def test_the_origin_of_a_centred_model_is_its_centre_of_mass() -> None:
    light, heavy = trimesh.creation.box((0.02,) * 3), trimesh.creation.box((0.04,) * 3)
    heavy.apply_translation((0.09, 0, 0))
    model = model_of(light, heavy)
    np.testing.assert_allclose(volume_and_centroid(model.collision_parts)[1], 0, atol=1e-12)
    np.testing.assert_allclose(model.bounds[:, 0], (-0.09, 0.03))


def test_moving_a_model_there_and_back_changes_nothing() -> None:
    model = model_of(trimesh.creation.cone(0.03, 0.1))
    pose = make_pose(Rotation.random(rng=3).as_matrix(), np.array([1.0, 2, 3]))
    back = model.moved(pose).moved(np.linalg.inv(pose))
    np.testing.assert_allclose(back.collision_parts[0], model.collision_parts[0], atol=1e-12)


@pytest.mark.parametrize(
    ("diameters", "parts"),
    [((1, 1), 1), ((1, 1, 1, 1), 1), ((1, 0.5, 0.2), 2), ((0.5, 1, 0.5), 1), ((1, 0.4, 1), 2)],
)
def test_a_loft_has_as_few_convex_parts_as_fill_it(diameters: tuple[float, ...], parts: int) -> None:
    loft = [Station(float(z), d, d, 2.0, "body") for z, d in enumerate(diameters)]
    assert len(convex_parts(loft)) == parts


def test_normals_are_sharp_at_edges_and_smooth_on_round_walls() -> None:
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere(subdivisions=3)
    expected = np.repeat(box.face_normals[:, None], 3, axis=1)
    np.testing.assert_allclose(crease_normals(np.array(box.triangles)), expected, atol=1e-12)
    np.testing.assert_allclose(crease_normals(np.array(ball.triangles)), ball.triangles, atol=0.02)


def test_each_triangle_finds_its_own_colour_in_a_painted_part() -> None:
    triangles = np.array(trimesh.creation.icosphere(subdivisions=1).triangles)
    colours = np.random.default_rng(0).integers(0, 256, (len(triangles), 3)).astype(np.uint8)
    part = painted_part(triangles, colours)
    assert part.uvs is not None
    assert part.texture is not None
    side = len(part.texture)
    column, row = (
        np.floor(part.uvs[:, 0] * side).astype(int),
        np.floor((1 - part.uvs[:, 1]) * side).astype(int),
    )
    np.testing.assert_array_equal(part.texture[row, column], np.repeat(colours, 3, axis=0))


def test_colours_are_decoded() -> None:
    assert colour_from_hex("#ffffff") == pytest.approx((1, 1, 1))
    assert colour_from_hex("#000000") == (0, 0, 0)
    assert linear_rgb(np.array([188, 0, 0]))[0] == pytest.approx(0.503, abs=0.002)


def test_what_stands_as_modelled_is_left_alone() -> None:
    upright = model_of(trimesh.creation.box((0.05, 0.08, 0.2)))
    np.testing.assert_allclose(stood_up(upright).collision_parts[0], upright.collision_parts[0], atol=1e-9)


@pytest.mark.parametrize("tilt", [0.5, np.pi / 4, np.pi])
def test_what_would_fall_is_laid_on_a_face(tilt: float) -> None:
    tilted = model_of(trimesh.creation.cone(0.03, 0.1)).moved(
        make_pose(Rotation.from_euler("x", tilt).as_matrix(), np.zeros(3))
    )
    stood = stood_up(tilted)
    touching = stood.collision_parts[0][:, 2] < stood.bounds[0, 2] + 1e-6
    assert touching.sum() >= 3
    assert stood.standing_height_m < tilted.standing_height_m
