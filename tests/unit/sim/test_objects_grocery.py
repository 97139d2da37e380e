"""The grocery objects have the declared size, are closed, and stand where they are put."""

import hashlib

import numpy as np
import pytest
import sapien
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from preshape.errors import InputError
from preshape.geometry.pose import make_pose
from sim.objects.actor import add_object
from sim.objects.grocery import FAMILIES, GROCERY_ITEMS, GrocerySet
from sim.objects.object_model import ObjectModel
from sim.physics import PhysicsSettings, make_scene
from sim.table import TableSettings, build_table

GROCERY = GrocerySet()
GLASS = {"sauce_bottle", "contour_bottle"}
HOLLOW = {"open_cup", "sleeve", "plate"}
"""Their holes collide as octagons, so that the walls are thicker than they look."""
BIGBIRD_NAMES = "c0fb4fb594560b88539e57f1041f32bb30c175fced6da5e838cd719efdfeffa3"
"""SHA-256 of the data set's list of objects, one name a line, sorted."""


def on_table(model: ObjectModel, yaw: float, above: float) -> tuple[sapien.Scene, sapien.Entity]:
    scene = make_scene(PhysicsSettings(), rendered=False)
    table = TableSettings()
    build_table(scene, table)
    position = np.array([*table.centre_m, table.top_m + model.standing_height_m + above])
    pose = make_pose(Rotation.from_euler("z", yaw).as_matrix(), position)
    return scene, add_object(scene, model, pose)


def test_the_names_are_those_of_bigbird() -> None:
    text = "\n".join(GROCERY.names)
    assert len(GROCERY.names) == 125
    assert hashlib.sha256(text.encode()).hexdigest() == BIGBIRD_NAMES


def test_every_shape_family_is_in_use() -> None:
    assert {item.family for item in GROCERY_ITEMS.values()} == set(FAMILIES)


@pytest.mark.parametrize("name", GROCERY.names)
class TestEveryItem:
    def test_size_is_as_declared(self, name: str) -> None:
        declared = np.array(GROCERY_ITEMS[name].size_mm) / 1000
        np.testing.assert_allclose(GROCERY.load(name).size, declared, atol=1e-3)

    def test_surface_is_closed_and_wraps_the_collision_parts(self, name: str) -> None:
        model = GROCERY.load(name)
        surface = trimesh.util.concatenate(
            [trimesh.Trimesh(part.vertices, part.faces) for part in model.visual_parts]
        )
        surface.merge_vertices(digits_vertex=7)
        assert surface.is_watertight
        assert surface.is_winding_consistent
        np.testing.assert_allclose(surface.bounds, model.bounds, atol=1e-3)
        if GROCERY_ITEMS[name].family in HOLLOW:
            assert 0.5 * model.volume_m3 < surface.volume < model.volume_m3
        else:
            assert surface.volume == pytest.approx(model.volume_m3, rel=0.05)

    def test_normals_point_outwards(self, name: str) -> None:
        for part in GROCERY.load(name).visual_parts:
            np.testing.assert_allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-5)
            faces = trimesh.Trimesh(part.vertices, part.faces, process=False).face_normals
            facing = np.einsum("fi,fci->fc", faces, part.normals[part.faces])
            assert facing.min() > 0.5

    def test_parts_suit_the_physics_engine(self, name: str) -> None:
        parts = GROCERY.load(name).collision_parts
        assert len(parts) <= (9 if GROCERY_ITEMS[name].family in HOLLOW else 6)
        for part in parts:
            assert len(ConvexHull(part).vertices) == len(part) <= 128

    def test_weighs_what_its_density_says(self, name: str) -> None:
        model = GROCERY.load(name)
        assert model.mass_kg == pytest.approx(GROCERY_ITEMS[name].mass_g / 1000)
        assert 100 < model.density < (1350 if GROCERY_ITEMS[name].family in GLASS else 1100)
        assert GrocerySet(density=100.0).load(name).density == pytest.approx(100)
        _, entity = on_table(model, 0.0, 0.0)
        body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        assert body.mass == pytest.approx(model.mass_kg, rel=4e-3)
        np.testing.assert_allclose(body.cmass_local_pose.p, 0, atol=5e-5)

    def test_stands_still_where_it_was_put(self, name: str) -> None:
        model = GROCERY.load(name)
        scene, entity = on_table(model, yaw=0.7, above=0.002)
        start = entity.pose
        for _ in range(480):
            scene.step()
        settled = entity.pose
        for _ in range(60):
            scene.step()
        assert np.linalg.norm(settled.p[:2] - start.p[:2]) < 1e-3
        assert settled.p[2] == pytest.approx(TableSettings().top_m + model.standing_height_m, abs=5e-4)
        assert abs(np.dot(settled.q, start.q)) > np.cos(np.deg2rad(0.5))
        np.testing.assert_allclose(entity.pose.p, settled.p, atol=1e-6)


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(InputError, match="no object 'pizza'"):
        GROCERY.load("pizza")


def test_the_fingerprint_follows_the_settings() -> None:
    assert GrocerySet().fingerprint == GROCERY.fingerprint
    assert GrocerySet(density=200.0).fingerprint != GROCERY.fingerprint
