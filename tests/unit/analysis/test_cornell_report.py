"""The report of a Cornell data set has its counts, folds, surfaces and a picture."""

from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from synthetic_cornell import POSITIVE, write_cornell

from analysis.cornell.report import CornellReport
from preshape.cornell.data_set import read_cornell
from preshape.cornell.label_agreement import label_agreement
from preshape.errors import InputError
from preshape.files import read_json, write_json


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cornell(tmp_path_factory.mktemp("cornell"), n=5)


def report(root: Path, output: Path) -> CornellReport:
    return CornellReport(
        root=str(root),
        output=str(output),
        shown=3,
        compared=2,
        seed=0,
        results=str(output / "none.json"),
        page=str(output / "results.md"),
    )


def test_the_report_says_what_there_is(root: Path, tmp_path: Path) -> None:
    said = report(root, tmp_path).write()
    assert "5 images of 5 objects, 5 positive and 5 negative rectangles, 0 dropped" in said
    figures = read_json(tmp_path / "cornell.json")
    assert [fold["images"] for fold in figures["folds"]["object_wise"]] == [1] * 5
    assert [fold["positives"] for fold in figures["folds"]["image_wise"]] == [1] * 5
    surfaces = figures["surfaces"]
    assert (surfaces["measured"], surfaces["approximate"]) == (1, 4)
    assert surfaces["difference"]["images"] == 1
    assert surfaces["difference"]["depth_m"] < 1e-3
    assert surfaces["difference"]["normal_rad"] < 0.05
    assert surfaces["flatness"]["approximate"]["plane_m"] < 1e-3
    page = (tmp_path / "cornell.md").read_text()
    assert "| images | 5 |" in page
    assert "In 1 images that have both" in page
    with Image.open(tmp_path / "contact_sheet.png") as sheet:
        assert sheet.width > 1000


def test_the_metric_is_applied_to_the_labels(tmp_path: Path) -> None:
    root = write_cornell(tmp_path, n=1)
    moved = POSITIVE.replace("300", "305").replace("340", "345")
    (root / "01/pcd0100cpos.txt").write_text(POSITIVE + moved)
    (root / "01/pcd0100cneg.txt").write_text(moved + "10 10\n10 40\n30 40\n30 10\n")
    figures = label_agreement(read_cornell(root).images)
    assert (figures["positives"]["n"], figures["positives"]["accepted"]) == (2, 2)
    assert (figures["negatives"]["n"], figures["negatives"]["accepted"]) == (2, 1)


def test_the_results_page_has_both_protocols_and_the_paper_beside_them(tmp_path: Path) -> None:
    said = {"command": "python src/detect.py", "git_revision": "abc"}
    corrected = {name: {"predicted": 0.8, "brier": 0.1} for name in ("temperature", "isotonic")}
    rate = {"value": 0.75, "low": 0.5, "high": 0.9, "n": 20}
    rows = [
        {"folds": folds, "data": "cornell", "metric": metric, **rate, **more, **said}
        for folds in ("image_wise", "object_wise")
        for metric, more in (
            ("recognition_auc", {}),
            ("detection_inference_4", {"predicted": 0.95, "brier": 0.2, "corrected": corrected}),
        )
    ]
    write_json(tmp_path / "cornell.json", {"runs": rows[:-1]})
    page = tmp_path / "results.md"
    page.write_text("# Results\n\nMore.\n")
    told = replace(report(tmp_path, tmp_path), root=None, results=str(tmp_path / "cornell.json"))
    assert str(page) in told.write()
    text = page.read_text()
    assert "More." in text
    assert (
        "| detection: inference from 4, as in the paper | 75 % [50, 90] of 20 | not run | 84 %, executed |"
        in text
    )
    assert "| recognition: AUC | 0.750 [0.500, 0.900] | 0.750 [0.500, 0.900] | – |" in text
    assert "| cornell | image-wise | 4 | 0.75 | 0.95 (Brier 0.200) | 0.80 (Brier 0.100) |" in text


def test_without_results_there_is_nothing_to_put_on_the_page(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        replace(report(tmp_path, tmp_path), root=None).write()


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not complete"):
        report(tmp_path, tmp_path / "out").write()
