"""The page holds everything it needs and says what the tables say."""

import re
from pathlib import Path

import lxml.html
import pytest
from synthetic_scenes import allegro_space

from analysis.pages.demo_page import DemoPage
from preshape.errors import InputError
from preshape.files import read_json
from preshape.hands.allegro import allegro_hand


def demo_page(
    folder: Path, output: Path, *, metrics: bool = True, climber: str = "inference", max_scenes: int = 20
) -> DemoPage:
    return DemoPage(
        evaluation=str(folder),
        metrics=str(folder / "metrics.json") if metrics else None,
        output=str(output),
        climber=climber,
        max_scenes=max_scenes,
        space=allegro_space(),
        hand=allegro_hand(),
    )


@pytest.fixture(scope="module")
def written(evaluation_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    output = tmp_path_factory.mktemp("page") / "demo.html"
    return demo_page(evaluation_folder, output).write(), output


@pytest.fixture(scope="module")
def page(written: tuple[str, Path]) -> lxml.html.HtmlElement:
    return lxml.html.fromstring(written[1].read_bytes())


def test_last_line_says_what_was_lifted_and_where_the_page_lies(
    written: tuple[str, Path], evaluation_folder: Path
) -> None:
    planners = read_json(evaluation_folder / "evaluation.json")["planners"]
    heuristic, inference = (planners[name] for name in ("heuristic", "inference"))
    assert written[0] == (
        f"Lifted: heuristic {heuristic['lifted']} of {heuristic['executed']}, "
        f"inference {inference['lifted']} of {inference['executed']}. Page: {written[1]}"
    )


def test_page_needs_no_other_file(written: tuple[str, Path], page: lxml.html.HtmlElement) -> None:
    sources = [element.get("src") for element in page.xpath("//*[@src]")]
    assert sources
    assert all(source.startswith("data:image/webp;base64,") for source in sources)
    assert all(link.startswith("#") for link in page.xpath("//@href"))
    assert not re.search(r"https?://|url\(|@import", written[1].read_text(encoding="utf-8"))


def test_every_scene_shows_view_channels_grasps_climb_and_films(page: lxml.html.HtmlElement) -> None:
    scenes = page.find_class("scene")
    assert [scene.get("id") for scene in scenes] == ["scene-0", "scene-1"]
    for scene in scenes:
        grasps = scene.find_class("grasp")
        assert len(grasps) == 3
        assert all(len(grasp.xpath(".//img")) == 2 for grasp in grasps)
        assert len(scene.find_class("best")) == 1
        assert len(scene.find_class("channels")) == 1
        assert len(scene.xpath(".//svg//polyline")) == 3
        assert scene.find_class("films")[0].xpath(".//img")


def test_outcomes_stand_below_the_grasp_that_was_tried(page: lxml.html.HtmlElement) -> None:
    for grasp in page.find_class("grasp"):
        before, after = (figure.text_content() for figure in grasp.xpath(".//figure"))
        assert "Heuristic" in before
        assert "Inference" not in before
        assert "Heuristic" not in after
    assert sum("Inference" in grasp.text_content() for grasp in page.find_class("grasp")) == 2


def test_pictures_have_a_text_and_outcomes_a_word(page: lxml.html.HtmlElement) -> None:
    assert all(image.get("alt") for image in page.xpath("//img"))
    assert all(chip.get("title") for chip in page.find_class("chip"))


def test_links_lead_to_the_scenes(page: lxml.html.HtmlElement) -> None:
    assert {link[1:] for link in page.xpath("//@href")} <= set(page.xpath("//@id"))


def test_figures_are_those_of_the_summary(page: lxml.html.HtmlElement, evaluation_folder: Path) -> None:
    planners = read_json(evaluation_folder / "evaluation.json")["planners"]
    figures = [figure.text_content() for figure in page.find_class("figure")]
    assert figures == [*(f"{it['lifted']} of {it['executed']}" for it in planners.values()), "0.81"]


def test_metrics_and_scenes_may_be_left_out(evaluation_folder: Path, tmp_path: Path) -> None:
    demo_page(evaluation_folder, tmp_path / "demo.html", metrics=False, max_scenes=1).write()
    page = lxml.html.fromstring((tmp_path / "demo.html").read_bytes())
    assert len(page.find_class("scene")) == 1
    assert len(page.find_class("tile")) == 2


def test_a_folder_without_evaluation_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no finished evaluation"):
        demo_page(tmp_path, tmp_path / "demo.html", metrics=False).write()
    assert list(tmp_path.iterdir()) == []


def test_a_planner_that_took_no_part_is_refused(evaluation_folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="took no part") as refusal:
        demo_page(evaluation_folder, tmp_path / "demo.html", climber="sampling").write()
    assert "heuristic, inference" in refusal.value.fix
