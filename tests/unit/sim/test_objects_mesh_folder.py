"""Folders of URDFs and meshes become objects, or are refused with one clear message."""

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
import sapien
import trimesh
from PIL import Image

from preshape.errors import InputError
from sim.objects.actor import add_object
from sim.objects.convex_decomposition import MOST_VERTICES, ConvexSettings
from sim.objects.mesh_folder import MeshFolder
from sim.objects.object_model import ObjectModel, volume_and_centroid
from sim.physics import PhysicsSettings, make_scene
from sim.table import TableSettings, build_table

YCB = Path(os.environ.get("PRESHAPE_SHARED", Path(__file__).parents[4] / "shared")) / "data" / "ycb"

# Not well-formed on purpose, as published URDFs are: no such XML version, stray text, a missing visual mesh.
URDF = """<?xml version="0.0" ?>
<robot name="thing">
  <link name="baseLink">
    <contact><lateral_friction value="0.8"/>g</contact>
    <inertial><mass value=".25"/></inertial>
    <visual>
      <origin xyz="0 0 0.01"/>
      <geometry><mesh filename="textured.obj" scale="1 1 1"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material>
    </visual>
    <collision>
      <origin xyz="0 0 0.01"/>
      <geometry><mesh filename="collision.obj" scale="1 1 1"/></geometry>
    </collision>
  </link>
</robot>"""


def hammer() -> list[trimesh.Trimesh]:
    """A head and a handle that touch: two convex pieces."""
    head, handle = trimesh.creation.box((0.03, 0.1, 0.03)), trimesh.creation.box((0.15, 0.02, 0.02))
    handle.apply_translation((0.09, 0, 0))
    return [head, handle]


def angle_iron() -> trimesh.Trimesh:
    """One closed L-shaped surface, which is not convex."""
    outline = np.array([[0, 0], [0.1, 0], [0.1, 0.02], [0.02, 0.02], [0.02, 0.1], [0, 0.1]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    return trimesh.creation.extrude_triangulation(outline, faces, height=0.05)


def write_obj(path: Path, meshes: list[trimesh.Trimesh]) -> None:
    path.write_text(trimesh.Scene(meshes).export(file_type="obj"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    root = tmp_path / "objects"
    root.mkdir()
    return root


def load(root: Path, name: str, **settings: object) -> ObjectModel:
    return objects(root, **settings).load(name)


def objects(root: Path, **settings: object) -> MeshFolder:
    return MeshFolder(root, root.parent / "cache", **settings)


class TestUrdf:
    @pytest.fixture
    def thing(self, folder: Path) -> Path:
        thing = folder / "Thing"
        thing.mkdir()
        (thing / "model.urdf").write_text(URDF)
        write_obj(thing / "collision.obj", hammer())
        return thing

    def test_mass_and_parts_are_the_files(self, thing: Path) -> None:
        model = load(thing.parent, "Thing")
        assert model.mass_kg == 0.25
        assert len(model.collision_parts) == 2
        assert model.volume_m3 == pytest.approx(0.03 * 0.1 * 0.03 + 0.15 * 0.02 * 0.02)

    def test_the_collision_mesh_is_shown_where_no_visual_mesh_is(self, thing: Path) -> None:
        (part, *_) = load(thing.parent, "Thing").visual_parts
        assert part.colour == pytest.approx((1, 0, 0))

    def test_a_material_that_no_file_declares_is_the_colour_of_the_urdf(self, thing: Path) -> None:
        corners = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nvt 0 0\nusemtl missing\n"
        faces = "f 1/1 3/1 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/1 4/1\n"
        (thing / "collision.obj").write_text("mtllib missing.mtl\n" + corners + faces)
        assert {part.colour for part in load(thing.parent, "Thing").visual_parts} == {(1.0, 0.0, 0.0)}

    def test_another_visual_mesh_stands_in_for_a_missing_one(self, thing: Path) -> None:
        write_obj(thing / "visual_2k.obj", [trimesh.creation.icosphere(radius=0.03)])
        (part,) = load(thing.parent, "Thing").visual_parts
        assert len(part.faces) == 1280

    def test_the_colour_of_a_lone_texture_is_used(self, thing: Path) -> None:
        Image.new("RGB", (8, 8), (0, 0, 255)).save(thing / "texture.png")
        (part, *_) = load(thing.parent, "Thing").visual_parts
        assert part.colour == pytest.approx((0, 0, 1))

    def test_scale_applies_to_meshes_and_origins(self, thing: Path) -> None:
        once, twice = load(thing.parent, "Thing"), load(thing.parent, "Thing", scale=2.0)
        np.testing.assert_allclose(twice.size, 2 * once.size, rtol=1e-6)

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("no xml at all", "not XML"),
            ("<robot/>", "0 links"),
            (URDF.replace('value=".25"', 'value="heavy"'), "number"),
            (URDF.replace("collision.obj", "nowhere.obj"), "cannot be read"),
            (URDF.replace("</robot>", '<link name="b"><visual/></link></robot>'), "2 links"),
        ],
    )
    def test_what_is_no_object_is_refused(self, thing: Path, text: str, complaint: str) -> None:
        (thing / "model.urdf").write_text(text)
        with pytest.raises(InputError, match=complaint):
            load(thing.parent, "Thing")

    def test_entities_are_not_followed(self, thing: Path, tmp_path: Path) -> None:
        (tmp_path / "secret").write_text("collision.obj")
        entity = f'<!DOCTYPE robot [<!ENTITY file SYSTEM "{tmp_path / "secret"}">]>'
        text = URDF.replace('<?xml version="0.0" ?>', entity).replace(
            '<mesh filename="collision.obj" scale="1 1 1"/>', "<mesh>&file;</mesh>"
        )
        (thing / "model.urdf").write_text(text)
        with pytest.raises(InputError, match=r"cannot be read|not read"):
            load(thing.parent, "Thing")


class TestBareMeshes:
    def test_each_file_is_an_object(self, folder: Path) -> None:
        box = trimesh.creation.box((0.05, 0.06, 0.1))
        for suffix in ("stl", "ply", "obj", "off", "glb"):
            box.export(folder / f"box_{suffix}.{suffix}")
        found = objects(folder)
        assert len(found.names) == 5
        for name in found.names:
            np.testing.assert_allclose(found.load(name).size, (0.05, 0.06, 0.1), atol=1e-6)
            assert found.load(name).density == pytest.approx(100)

    def test_sub_folders_name_their_objects(self, folder: Path) -> None:
        for place in ("alone/mesh.stl", "pair/left.stl", "pair/right.stl"):
            (folder / place).parent.mkdir(exist_ok=True)
            trimesh.creation.box((0.05, 0.06, 0.1)).export(folder / place)
        assert objects(folder).names == ("alone", "pair_left", "pair_right")

    def test_vertex_colours_are_kept(self, folder: Path) -> None:
        ball = trimesh.creation.icosphere(radius=0.03)
        ball.visual.vertex_colors = np.where(ball.vertices[:, [2]] > 0, (255, 0, 0, 255), (0, 0, 255, 255))
        ball.export(folder / "ball.ply")
        (part,) = load(folder, "ball").visual_parts
        assert part.texture is not None
        assert {(255, 0, 0), (0, 0, 255)} <= {tuple(pixel) for pixel in part.texture.reshape(-1, 3).tolist()}

    def test_a_texture_is_kept(self, folder: Path) -> None:
        (folder / "sheet.mtl").write_text("newmtl paint\nmap_Kd paint.png\n")
        Image.new("RGB", (16, 16), (10, 200, 30)).save(folder / "paint.png")
        corners = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl paint\n"
        faces = "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
        (folder / "wedge.obj").write_text("mtllib sheet.mtl\n" + corners + faces)
        (part,) = load(folder, "wedge").visual_parts
        assert part.texture is not None
        assert part.texture.shape == (16, 16, 3)
        assert tuple(part.texture[3, 3]) == (10, 200, 30)
        assert part.uvs is not None
        assert sorted({tuple(uv) for uv in part.uvs.tolist()}) == [(0, 0), (0, 1), (1, 0)]

    def test_a_fine_ball_is_thinned_for_the_physics_engine(self, folder: Path) -> None:
        trimesh.creation.icosphere(subdivisions=4, radius=0.04).export(folder / "ball.stl")
        model = load(folder, "ball")
        assert len(model.collision_parts[0]) <= MOST_VERTICES
        np.testing.assert_allclose(model.size, 0.08, rtol=0.03)

    def test_a_hollow_shape_is_decomposed_once(self, folder: Path) -> None:
        angle_iron().export(folder / "iron.stl")
        model = load(folder, "iron")
        assert len(model.collision_parts) >= 2
        assert volume_and_centroid(model.collision_parts)[0] == pytest.approx(angle_iron().volume, rel=0.1)
        (remembered,) = (folder.parent / "cache").iterdir()
        first = remembered.stat().st_mtime_ns
        again = load(folder, "iron", friction=0.5)
        assert remembered.stat().st_mtime_ns == first
        for part, expected in zip(again.collision_parts, model.collision_parts, strict=True):
            np.testing.assert_array_equal(part, expected)

    def test_a_damaged_cache_is_made_again_and_never_unpickled(self, folder: Path) -> None:
        angle_iron().export(folder / "iron.stl")
        parts = len(load(folder, "iron").collision_parts)
        (remembered,) = (folder.parent / "cache").iterdir()
        remembered.write_bytes(pickle.dumps(np.zeros(3)))
        assert len(load(folder, "iron", friction=0.5).collision_parts) == parts
        assert remembered.read_bytes()[:2] == b"PK"

    def test_the_decomposition_follows_its_settings(self, folder: Path) -> None:
        angle_iron().export(folder / "iron.stl")
        coarse = ConvexSettings(most_parts=1)
        assert len(load(folder, "iron", convex=coarse).collision_parts) == 1

    def test_the_fingerprint_follows_files_and_settings(self, folder: Path) -> None:
        trimesh.creation.box((0.05, 0.06, 0.1)).export(folder / "box.stl")
        before = objects(folder).fingerprint
        assert objects(folder).fingerprint == before
        assert objects(folder, scale=2.0).fingerprint != before
        trimesh.creation.box((0.05, 0.06, 0.11)).export(folder / "box.stl")
        assert objects(folder).fingerprint != before


class TestBadInput:
    def test_a_missing_folder(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="does not exist"):
            objects(tmp_path / "nowhere")

    def test_a_folder_without_meshes(self, folder: Path) -> None:
        (folder / "readme.txt").write_text("nothing here")
        with pytest.raises(InputError, match="no meshes"):
            objects(folder)

    def test_millimetres_are_noticed_and_can_be_scaled(self, folder: Path) -> None:
        trimesh.creation.box((50, 60, 100)).export(folder / "box.stl")
        with pytest.raises(InputError, match=r"looks like millimetres[\s\S]*objects.scale=0.001"):
            load(folder, "box")
        np.testing.assert_allclose(load(folder, "box", scale=0.001).size, (0.05, 0.06, 0.1), atol=1e-6)

    def test_what_is_too_tiny(self, folder: Path) -> None:
        trimesh.creation.box((5e-5, 6e-5, 1e-4)).export(folder / "box.stl")
        with pytest.raises(InputError, match="too tiny"):
            load(folder, "box")

    def test_a_scale_that_is_none(self, folder: Path) -> None:
        with pytest.raises(InputError, match=r"objects\.scale"):
            objects(folder, scale=0.0)

    @pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "off", "glb", "gltf"])
    @pytest.mark.parametrize("content", [b"", b"garbage\n" * 20, pickle.dumps({"vertices": [1, 2]})])
    def test_an_unreadable_mesh(self, folder: Path, suffix: str, content: bytes) -> None:
        (folder / f"mesh.{suffix}").write_bytes(content)
        with pytest.raises(InputError, match=f"mesh.{suffix}"):
            load(folder, "mesh")

    def test_a_mesh_without_numbers(self, folder: Path) -> None:
        (folder / "mesh.obj").write_text("v 0 0 nan\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\n")
        with pytest.raises(InputError, match="not finite"):
            load(folder, "mesh")

    def test_a_flat_mesh(self, folder: Path) -> None:
        (folder / "mesh.obj").write_text("v 0 0 0\nv 0 .1 0\nv .1 0 0\nf 1 2 3\n")
        with pytest.raises(InputError, match="flat"):
            load(folder, "mesh")

    def test_two_files_of_one_name(self, folder: Path) -> None:
        for suffix in ("stl", "ply"):
            trimesh.creation.box((0.05, 0.06, 0.1)).export(folder / f"box.{suffix}")
        with pytest.raises(InputError, match="Two files"):
            objects(folder)

    def test_an_unknown_name(self, folder: Path) -> None:
        trimesh.creation.box((0.05, 0.06, 0.1)).export(folder / "box.stl")
        with pytest.raises(InputError, match="choose one of: box"):
            load(folder, "ball")


@pytest.mark.skipif(not YCB.is_dir(), reason="needs the YCB sample in ../shared/data/ycb (PRESHAPE_SHARED)")
def test_scanned_objects_come_to_rest_and_stay(tmp_path: Path) -> None:
    scans = MeshFolder(YCB, tmp_path)
    assert len(scans.names) == 8
    for name in scans.names:
        model = scans.load(name)
        scene = make_scene(PhysicsSettings(), rendered=False)
        table = TableSettings()
        build_table(scene, table)
        pose = np.eye(4)
        pose[:3, 3] = (*table.centre_m, table.top_m + model.standing_height_m + 0.002)
        entity = add_object(scene, model, pose)
        for _ in range(480):
            scene.step()
        settled = entity.pose
        for _ in range(120):
            scene.step()
        body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        assert body.mass == pytest.approx(model.mass_kg, rel=5e-3)
        assert settled.to_transformation_matrix()[2, 2] > np.cos(np.deg2rad(2))
        np.testing.assert_allclose(settled.p[:2], table.centre_m, atol=2e-3)
        np.testing.assert_allclose(entity.pose.p, settled.p, atol=1e-5)
