"""Data sets in Cornell's own layout are read; what is missing, flawed or damaged is said."""

import logging
import os
import shutil
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from synthetic_cornell import POSITIVE, write_cornell, write_image, write_objects

from preshape.cornell.data_set import CornellDataSet, read_cornell
from preshape.cornell.object_list import Subject
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_files import Flaw, read_rectangles
from preshape.cornell.views import Surface, load_cornell_view, load_surface
from preshape.errors import InputError

FUZZ = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
IMAGES = ("01/pcd0101r.png", "01/pcd0101d.tiff", "01/pcd0100.txt")
READ = (
    *IMAGES,
    "01/pcd0101cpos.txt",
    "01/pcd0101cneg.txt",
)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cornell(tmp_path_factory.mktemp("cornell"), n=2)


@pytest.fixture
def root(written: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written, tmp_path / "data", copy_function=os.link))


def replace(path: Path, content: bytes | str) -> None:
    """Write a file of a linked tree anew, so that the original stays as it was."""
    path.unlink()
    path.write_bytes(content.encode() if isinstance(content, str) else content)


def load_all(root: Path) -> None:
    for image in read_cornell(root).images:
        load_cornell_view(image.files)


def read_or_refused(root: Path) -> CornellDataSet | str:
    """The data set, or what the error says."""
    try:
        return read_cornell(root)
    except InputError as refusal:
        return str(refusal)


class TestLayout:
    def test_images_objects_and_rectangles_are_read(self, root: Path) -> None:
        data = read_cornell(root)
        assert data.objects == {100: 50, 101: 51}
        assert data.dropped == dict.fromkeys(Flaw, 0)
        image = data.images[0]
        assert image.subject == Subject(50, "Block", "pcdb_0002")
        assert image.positives == (GraspRectangle(320.0, 260.0, 0.0, 40.0, 20.0),)
        assert [(own.opening_px, own.jaw_px) for own in image.negatives] == [(30, 20)]

    def test_all_files_may_lie_in_one_folder_or_be_sorted_by_kind(self, root: Path) -> None:
        expected = read_cornell(root).objects
        shutil.move(root / "01" / "pcd0100r.png", root / "pcd0100r.png")
        (root / "labels").mkdir()
        for path in (root / "01").glob("*cpos.txt"):
            shutil.move(path, root / "labels" / path.name)
        shutil.move(root / "processedData" / "z.txt", root / "z.txt")
        assert read_cornell(root).objects == expected

    @pytest.mark.parametrize("name", ["pcd0101r.png", "pcd0101cpos.txt", "pcd0101cneg.txt", "pcd0101d.tiff"])
    def test_a_missing_file_is_named_with_the_origin(self, root: Path, name: str) -> None:
        (root / "01" / name).unlink()
        with pytest.raises(InputError, match="1 complete and 1 incomplete") as refusal:
            read_cornell(root)
        assert name in str(refusal.value)
        assert "kaggle.com" in str(refusal.value)

    def test_a_missing_list_of_objects_is_said(self, root: Path) -> None:
        (root / "processedData" / "z.txt").unlink()
        with pytest.raises(InputError, match=r"2 complete.*list of objects is missing"):
            read_cornell(root)

    def test_an_empty_and_a_missing_folder_are_said(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match=r"0 complete.*pcdNNNNr\.png"):
            read_cornell(tmp_path)
        with pytest.raises(InputError, match="does not exist"):
            read_cornell(tmp_path / "elsewhere")

    def test_only_some_of_many_incomplete_images_are_named(self, tmp_path: Path) -> None:
        for number in range(100, 120):
            (tmp_path / f"pcd{number:04d}r.png").touch()
        with pytest.raises(InputError, match="15 more images lack something") as refusal:
            read_cornell(tmp_path)
        assert len(refusal.value.what) < 1000

    def test_an_image_that_is_there_twice_is_refused(self, root: Path) -> None:
        shutil.copytree(root / "01", root / "copy")
        with pytest.raises(InputError, match="twice"):
            read_cornell(root)

    @pytest.mark.parametrize(
        "text",
        ["0100 50 Block pcdb_0002\n", "0100 50 Block pcdb_0002\n0101 5", "0100 1 A b\n0100 2 A b\n", ""],
    )
    def test_a_truncated_or_contradictory_list_of_objects_is_refused(self, root: Path, text: str) -> None:
        replace(root / "processedData" / "z.txt", text)
        with pytest.raises(InputError, match=r"z\.txt"):
            read_cornell(root)


class TestRectangles:
    @pytest.mark.parametrize(
        ("vertices", "flaw"),
        [
            ("NaN NaN\n256 313\n277 313\nNaN NaN\n", Flaw.NO_NUMBER),
            ("inf 1\n256 313\n277 313\n1 1\n", Flaw.NO_NUMBER),
            ("-9 10\n20 10\n20 30\n-9 30\n", Flaw.OFF_IMAGE),
            ("600 470\n630 470\n630 490\n600 490\n", Flaw.OFF_IMAGE),
            ("300 250\n340 250\n34 270\n300 270\n", Flaw.NO_RECTANGLE),
            ("3 2\n" * 4, Flaw.NO_RECTANGLE),
        ],
    )
    def test_flawed_ones_are_dropped_counted_and_said_in_one_line(
        self, root: Path, caplog: pytest.LogCaptureFixture, vertices: str, flaw: Flaw
    ) -> None:
        replace(root / "01/pcd0101cpos.txt", vertices + POSITIVE)
        with caplog.at_level(logging.WARNING):
            data = read_cornell(root)
        assert data.dropped == dict.fromkeys(Flaw, 0) | {flaw: 1}
        assert data.images[1].positives == data.images[0].positives
        (message,) = caplog.messages
        assert message == f"Left out 1 rectangles: 1 {flaw} (in pcd0101cpos)"

    def test_an_image_may_have_no_negatives_but_needs_positives(self, root: Path) -> None:
        replace(root / "01/pcd0101cneg.txt", "")
        assert read_cornell(root).images[1].negatives == ()
        replace(root / "01/pcd0101cpos.txt", "\n")
        with pytest.raises(InputError, match="empty"):
            read_cornell(root)

    @pytest.mark.parametrize(
        "vertices", ["1 2\n3 4\n", POSITIVE + "5 5", "1 2 3\n" * 4, "a b\n" * 4, "1\n" * 4]
    )
    def test_other_content_is_refused(self, root: Path, vertices: str) -> None:
        replace(root / "01/pcd0101cneg.txt", vertices)
        with pytest.raises(InputError, match="pcd0101cneg"):
            read_cornell(root)

    @FUZZ
    @given(content=st.binary(max_size=80) | st.text("0123456789.-eNanif \n", max_size=80).map(str.encode))
    def test_whatever_a_file_holds_ends_in_rectangles_or_one_error(
        self, tmp_path: Path, content: bytes
    ) -> None:
        path = tmp_path / "pcd0100cpos.txt"
        path.write_bytes(content)
        usable = ()
        with suppress(InputError):
            usable = read_rectangles(path).usable
        for own in usable:
            assert np.isfinite(own.corners()).all()
            assert own.opening_px > 0
            assert own.jaw_px > 0


class TestDamage:
    @pytest.mark.parametrize("name", IMAGES)
    @pytest.mark.parametrize("share", [0.0, 0.4, 0.97])
    def test_every_image_may_be_truncated(self, root: Path, name: str, share: float) -> None:
        content = (root / name).read_bytes()
        replace(root / name, content[: int(share * len(content))])
        with pytest.raises(InputError, match=Path(name).name):
            load_all(root)

    @pytest.mark.parametrize("name", ["01/pcd0101cpos.txt", "01/pcd0101cneg.txt", "processedData/z.txt"])
    def test_labels_may_be_truncated_anywhere(self, root: Path, name: str) -> None:
        content, whole = (root / name).read_bytes(), read_cornell(root)
        for length in range(0, len(content), 3):
            replace(root / name, content[:length])
            read = read_or_refused(root)
            if isinstance(read, str):
                assert Path(name).name in read
                continue
            # never another rectangle or object than before; a lost one is counted, unless the file is empty
            assert read.objects == whole.objects
            for own, before in zip(read.images, whole.images, strict=True):
                assert set(own.positives) <= set(before.positives)
                assert set(own.negatives) <= set(before.negatives)
            kept = sum(len(own.positives) + len(own.negatives) for own in read.images)
            assert kept + sum(read.dropped.values()) == 4 or length == 0

    def test_rectangles_may_be_truncated_anywhere(self, tmp_path: Path) -> None:
        path = tmp_path / "pcd0100cpos.txt"
        for length in range(1, len(POSITIVE)):
            path.write_text(POSITIVE[:length])
            with suppress(InputError):
                labelled = read_rectangles(path)
                # what is lost is white space, or the rectangle is dropped
                assert labelled.dropped or POSITIVE[:length].rstrip() == POSITIVE.rstrip()

    @pytest.mark.parametrize("name", READ)
    def test_every_file_may_be_another(self, root: Path, name: str) -> None:
        for content in (b"\0" * 5000, os.urandom(5000), (root / "01/pcd0101r.png").read_bytes() + b"x"):
            replace(root / name, content)
            if not (name.endswith(".png") and content.endswith(b"x")):
                with pytest.raises(InputError, match=Path(name).name):
                    load_all(root)

    @pytest.mark.parametrize("name", ["01/pcd0101r.png", "01/pcd0101d.tiff", "01/pcd0101cpos.txt"])
    def test_a_folder_in_place_of_a_file_is_refused(self, root: Path, name: str) -> None:
        (root / name).unlink()
        (root / name).mkdir()
        with pytest.raises(InputError, match=Path(name).name):
            load_all(root)

    def test_a_surface_that_is_not_there_is_said(self, root: Path) -> None:
        with pytest.raises(InputError, match="0101 has no measured surface"):
            load_surface(read_cornell(root).images[1].files, Surface.MEASURED)


def test_real_images_are_read(cornell_sample: Path) -> None:
    data = read_cornell(cornell_sample)
    assert data.dropped[Flaw.NO_NUMBER] == 3
    assert all(image.positives for image in data.images)


def test_folders_may_have_any_number(tmp_path: Path) -> None:
    write_image(tmp_path / "10", 1034)
    write_objects(tmp_path, {1034: 7})
    assert read_cornell(tmp_path).objects == {1034: 7}
