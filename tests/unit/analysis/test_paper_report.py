"""The report shows every result file beside the paper, says where its numbers come from, and stands alone."""

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from hydra import compose, initialize_config_dir
from hydra.utils import instantiate

import preshape.command_line.entry_point  # noqa: F401 - registers the resolvers
from analysis.pages.robot_sections import GRIPPER
from preshape.errors import InputError
from preshape.files import file_hash, read_json, write_json
from preshape.paths import project_root

RESULTS = project_root() / "results"
PLANNERS = {"heuristic", "inference", "paper_constrained"}


class Page(HTMLParser):
    """Anchors, links and embedded resources of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.resources: list[str] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.ids += [given["id"]] if "id" in given else []
        if tag == "a":
            self.links.append(given["href"])
        elif tag in {"link", "script", "iframe", "object", "embed", "video", "audio", "source"}:
            self.resources.append(tag)
        elif "src" in given:
            self.resources.append(given["src"])

    def handle_data(self, data: str) -> None:
        self.words += " " + " ".join(data.split())


def write_report(results: Path, output: Path) -> Path:
    with initialize_config_dir(str(project_root() / "conf"), version_base="1.3"):
        cfg = compose("report", [f"report.results={results}", f"report.output={output / 'report.html'}"])
    assert str(output / "report.html") in instantiate(cfg.report).write()
    return output / "report.html"


def fewer(content: dict[str, Any]) -> dict[str, Any]:
    """The planning experiment with few planners and objects, which are drawn sooner."""
    runs = [run for run in content["runs"] if run["planner"] in PLANNERS]
    short = {"runs": [run | {"objects": dict(list(run["objects"].items())[:3])} for run in runs]}
    tests = ("tests", "tests_of_all_scenes")
    return (
        content | short | {key: [one for one in content[key] if one["against"] in PLANNERS] for key in tests}
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped result files, and one of the gripper's experiment."""
    folder = tmp_path_factory.mktemp("results")
    for path in RESULTS.glob("*.json"):
        (folder / path.name).write_bytes(path.read_bytes())
    content = read_json(RESULTS / "planning.json")
    short = fewer(content) | {"paper_network": fewer(content["paper_network"]), "rounds": []}
    write_json(folder / "planning.json", short)
    scans = short | {"runs": [run for run in short["runs"] if run["condition"] == "scans"]}
    write_json(folder / "two_finger.json", scans)
    return folder


@pytest.fixture(scope="module")
def page(results: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(results, tmp_path_factory.mktemp("report"))


def test_the_page_needs_no_other_file_and_its_links_lead_somewhere(page: Path) -> None:
    found = Page(page.read_text(encoding="utf-8"))
    assert found.resources
    assert all(resource.startswith("data:image/") for resource in found.resources)
    assert "url(" not in page.read_text(encoding="utf-8").split("</style>")[0]
    assert len(found.ids) == len(set(found.ids))
    for link in found.links:
        if link.startswith("#"):
            assert link[1:] in found.ids
        else:
            assert (page.parent / link).read_bytes().startswith(b"%PDF")


def test_every_number_has_its_command_revision_versions_and_hash(results: Path, page: Path) -> None:
    words = Page(page.read_text(encoding="utf-8")).words
    for path in results.glob("*.json"):
        content = read_json(path)
        assert file_hash(path) in words
        assert " ".join(content["command"].split()) in words
        for key in ("git_revision", "date"):
            assert content[key] in words
        assert all(f"{name} {version}" in words for name, version in content["versions"].items())
    for condition in read_json(results / "planning.json")["conditions"].values():
        assert condition["command"] in words


def test_planners_stand_beside_the_paper_with_their_counts(results: Path, page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    rows = [re.sub(r"<[^>]+>", "|", row) for row in re.findall(r"<tr>.*?</tr>", text, re.DOTALL)]
    content = read_json(results / "planning.json")
    for run in content["runs"]:
        if run["condition"] in {"seen", "unseen"}:
            counts = f"|{run['lifted']} of {run['executed']}|"
            interval = f"[{100 * run['low']:.0f}, {100 * run['high']:.0f}]"
            assert any(counts in row and interval in row for row in rows)
    inference = next(row for row in rows if "|Inference|" in row and "|default|" in row and "|seen|" in row)
    assert "|62 %|" in inference
    assert any("|Heuristic|" in row and "|40 %|" in row for row in rows)
    assert any("|paper, config-CNN|" in row and "0.766 (0.038)" in row for row in rows)


def test_planners_that_the_gripper_is_shown_with_are_those_that_it_was_measured_with() -> None:
    measured = {run["planner"] for run in read_json(RESULTS / "two_finger.json")["runs"]}
    assert set(GRIPPER) <= measured


def test_what_has_no_result_is_named_with_its_command(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "crash_test.json").write_bytes((RESULTS / "crash_test.json").read_bytes())
    words = Page(write_report(folder, tmp_path).read_text(encoding="utf-8")).words
    for command in (
        "python sim/collect.py collect.trials=10000",
        "python src/train.py --multirun experiment=paper model=regression split=seen,unseen fold=0,1,2,3,4",
        "python sim/evaluate.py experiment=planning",
        "python analysis/report.py report=gripper robot=baxter",
        "python sim/sensitivity.py",
        "make bench",
    ):
        assert command in words
    assert words.count("not measured yet") > 8


def test_a_file_without_its_origin_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no result file"):
        write_report(tmp_path, tmp_path)
    write_json(tmp_path / "dataset.json", {"command": "python x.py", "lifted": 3})
    with pytest.raises(InputError, match="does not say its git_revision"):
        write_report(tmp_path, tmp_path)
