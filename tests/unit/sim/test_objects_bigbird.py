"""BigBIRD's own folders become objects, or are refused with one message that says what is there."""

import logging
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import sapien
import trimesh
from synthetic_bigbird import BOX_SIZE, MESH, RED, TEXTURED, box_mesh, write_meshes

from preshape.errors import InputError
from sim.objects import convex_decomposition
from sim.objects.actor import add_object
from sim.objects.bigbird_folder import BigbirdFolder
from sim.objects.convex_decomposition import ConvexSettings, convex_parts
from sim.objects.object_model import ObjectModel, volume_and_centroid
from sim.physics import PhysicsSettings, make_scene
from sim.table import TableSettings, build_table

NAME = "red_box"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "bigbird"
    root.mkdir()
    return root


def objects(root: Path, **settings: object) -> BigbirdFolder:
    return BigbirdFolder(root, root.parent / "cache", **settings)


def tilted_scan() -> trimesh.Trimesh:
    """The box as a scanner leaves it: lying askew, each face by itself, and open where it stood."""
    scan = box_mesh().subdivide()
    scan.update_faces(scan.triangles_center[:, 2] > 0.001)
    scan.unmerge_vertices()
    scan.apply_transform(trimesh.transformations.euler_matrix(0.9, 0.4, 0.2))
    return scan


def settled_pose(model: ObjectModel) -> sapien.Pose:
    """Where the object rests half a second after it was put on the table."""
    scene = make_scene(PhysicsSettings(), rendered=False)
    table = TableSettings()
    build_table(scene, table)
    pose = np.eye(4)
    pose[:3, 3] = (*table.centre_m, table.top_m + model.standing_height_m + 0.002)
    entity = add_object(scene, model, pose)
    for _ in range(480):
        scene.step()
    return entity.pose


class TestMeshes:
    @pytest.mark.parametrize("place", ["", "processed"])
    def test_an_object_is_its_meshes(self, root: Path, place: str) -> None:
        write_meshes(root / NAME / place, box_mesh())
        found = objects(root)
        assert (found.name, found.names) == ("bigbird", (NAME,))
        model = found.load(NAME)
        np.testing.assert_allclose(model.size, BOX_SIZE, atol=1e-6)
        assert model.density == pytest.approx(100)
        (part,) = model.visual_parts
        assert part.texture is not None
        assert np.abs(part.texture.reshape(-1, 3).astype(int) - RED).max() < 3

    def test_density_and_friction_can_be_set(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh())
        model = objects(root, density=400.0, friction=0.3).load(NAME)
        assert model.mass_kg == pytest.approx(400 * np.prod(BOX_SIZE))
        assert model.friction == 0.3

    def test_a_tilted_open_scan_stands_still_on_the_table(self, root: Path) -> None:
        write_meshes(root / NAME, tilted_scan(), textured=False)
        model = objects(root).load(NAME)
        assert model.volume_m3 == pytest.approx(np.prod(BOX_SIZE), rel=0.05)
        pose = settled_pose(model)
        assert pose.to_transformation_matrix()[2, 2] > np.cos(np.deg2rad(2))
        np.testing.assert_allclose(pose.p[:2], TableSettings().centre_m, atol=2e-3)

    def test_an_object_without_a_textured_mesh_is_shown_as_it_collides(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh(), textured=False)
        (part,) = objects(root).load(NAME).visual_parts
        assert len(part.faces) == 12

    def test_a_texture_without_material_colours_the_object(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh())
        (root / NAME / f"{TEXTURED}.mtl").unlink()
        (part,) = objects(root).load(NAME).visual_parts
        red, green, blue = part.colour
        assert red > 5 * max(green, blue)

    def test_the_fingerprint_follows_both_meshes(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh())
        seen = {objects(root).fingerprint}
        (root / NAME / "NP1_0.jpg").write_bytes(b"captures are none of its business")
        assert objects(root).fingerprint in seen
        for name in (MESH, f"{TEXTURED}.obj"):
            with (root / NAME / name).open("ab") as file:
                file.write(b"\n")
            seen.add(objects(root).fingerprint)
        assert len(seen) == 3


def test_holes_are_filled_and_fine_scans_thinned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    outline = np.array([[0, 0], [0.1, 0], [0.1, 0.02], [0.02, 0.02], [0.02, 0.1], [0, 0.1]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    iron = trimesh.creation.extrude_triangulation(outline, triangles, height=0.05)
    fine = iron.subdivide().subdivide().subdivide()
    fine.update_faces(fine.triangles_center[:, 2] > 1e-4)
    assert not fine.is_watertight
    for most_faces in (300, 3000):
        monkeypatch.setattr(convex_decomposition, "MOST_DECOMPOSED_FACES", most_faces)
        parts = convex_parts([fine], ConvexSettings(), tmp_path)
        assert len(parts) >= 2
        assert volume_and_centroid(parts)[0] == pytest.approx(iron.volume, rel=0.1)
    assert len(list(tmp_path.iterdir())) == 2


class TestIncomplete:
    def test_objects_without_their_mesh_are_left_out_with_one_warning(
        self, root: Path, caplog: pytest.LogCaptureFixture
    ) -> None:
        write_meshes(root / NAME, box_mesh())
        for name in ("palmolive_green", "listerine_green"):
            (root / name).mkdir()
        with caplog.at_level(logging.WARNING):
            assert objects(root).names == (NAME,)
        (warning,) = caplog.messages
        assert "listerine_green, palmolive_green" in warning

    def test_a_half_extracted_folder_says_what_is_there(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh())
        (root / NAME / MESH).unlink()
        (root / "spam").mkdir()
        (root / "spam" / "processed.tgz").write_bytes(b"")
        with pytest.raises(InputError) as error:
            objects(root)
        said = str(error.value)
        for part in (
            *("meshes/poisson.ply", "sub-folders: 2 (red_box, spam)", "textured objects: 1 (red_box)"),
            *("archives: 1 (processed.tgz)", "rll.berkeley.edu/bigbird", str(root)),
        ):
            assert part in said

    def test_an_empty_folder(self, root: Path) -> None:
        with pytest.raises(InputError, match="sub-folders: 0; textured objects: 0; archives: 0"):
            objects(root)

    def test_a_missing_folder(self, root: Path) -> None:
        with pytest.raises(InputError, match=r"does not exist[\s\S]*rll.berkeley.edu/bigbird"):
            objects(root / "nowhere")

    def test_the_folder_of_one_object(self, root: Path) -> None:
        write_meshes(root / NAME / "processed", box_mesh())
        with pytest.raises(InputError, match=rf"one object[\s\S]*objects.root[\s\S]*{root}"):
            objects(root / NAME)

    def test_an_unknown_name(self, root: Path) -> None:
        write_meshes(root / NAME, box_mesh())
        with pytest.raises(InputError, match=f"choose one of: {NAME}"):
            objects(root).load("spam")

    @pytest.mark.parametrize("keep", [0.0, 0.5, 0.9])
    @pytest.mark.parametrize("encoding", ["ascii", "binary"])
    def test_a_truncated_mesh_is_named(self, root: Path, encoding: str, keep: float) -> None:
        write_meshes(root / NAME, box_mesh(), textured=False)
        content = box_mesh().subdivide().export(file_type="ply", encoding=encoding)
        (root / NAME / MESH).write_bytes(content[: int(keep * len(content))])
        with pytest.raises(InputError) as error:
            objects(root).load(NAME)
        assert error.value.where == str(root / NAME / MESH)

    @pytest.mark.parametrize("keep", [0.0, 0.3, 0.6, 0.9])
    def test_whichever_truncated_file_of_its_looks_is_refused_or_harmless(
        self, root: Path, keep: float
    ) -> None:
        write_meshes(root / NAME, box_mesh())
        for path in sorted((root / NAME / TEXTURED).parent.iterdir()):
            content = path.read_bytes()
            path.write_bytes(content[: int(keep * len(content))])
            with suppress(InputError):
                assert objects(root, friction=keep).load(NAME).volume_m3 == pytest.approx(np.prod(BOX_SIZE))
            path.write_bytes(content)
