"""Result files, tables and pictures that the commands keep up to date."""

from pathlib import Path

import pytest
from PIL import Image
from synthetic_scenes import allegro_space, write_data_set

from analysis.dataset.film_strip import MOMENTS, save_film_strip
from analysis.dataset.object_table import ObjectTable, table_lines
from analysis.first_pass import FirstPass
from analysis.results_page import put_section
from preshape.data.tables import read_data_set
from preshape.errors import InputError
from preshape.evaluation.intervals import wilson
from preshape.files import read_json


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    write_data_set(folder, n_scenes=12)
    return folder


def test_first_pass_holds_the_agreed_keys(data: Path, evaluation_folder: Path, tmp_path: Path) -> None:
    output = tmp_path / "first_pass.json"
    report = FirstPass(
        data=str(data),
        metrics=str(evaluation_folder / "metrics.json"),
        evaluation=str(evaluation_folder),
        output=str(output),
        space=allegro_space(),
    )
    assert str(output) in report.write()
    content = read_json(output)
    trials = read_data_set(data, allegro_space())[1]
    assert list(content)[:5] == ["command", "git_revision", "versions", "seed", "date"]
    assert (content["trials"], content["executed"]) == (len(trials), len(trials.executed))
    assert content["lifted"] == trials.lifted.sum()
    assert [content["low"], content["high"]] == list(wilson(content["lifted"], content["executed"]))
    assert {"value", "low", "high", "n"} <= set(content["auc"])
    assert sum(face["lifted"] for face in content["faces"].values()) == content["lifted"]
    assert 0 <= content["auc_of_grasp_type"] <= 1
    assert {"executed", "lifted", "low", "high"} <= set(content["planners"]["inference"])
    assert set(content["seconds_per_trial"]) == {"scene", "planning", "physics", "rendering"}


def test_object_table_adds_up(data: Path) -> None:
    trials = read_data_set(data, allegro_space())[1]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table_lines(trials)[2:]]
    counts = [[int(row[column]) for column in (1, 2, 5)] for row in rows]
    assert [sum(column) for column in zip(*counts[:-1], strict=True)] == counts[-1]
    assert counts[-1] == [len(trials.executed), trials.lifted.sum(), len(trials) - len(trials.executed)]


def test_object_section_shows_a_film_of_each_outcome(
    data: Path, evaluation_folder: Path, tmp_path: Path
) -> None:
    films = tmp_path / "films"
    films.mkdir()
    film = next((evaluation_folder / "animations").glob("*.webp"))
    trials = read_data_set(data, allegro_space())[1]
    lifted_id = trials.rows[trials.lifted]["trial_id"].iloc[1]
    (films / f"{lifted_id}.webp").write_bytes(film.read_bytes())
    page = tmp_path / "results.md"
    ObjectTable(str(data), str(films), str(page), "boxes", "Boxes", allegro_space()).write()
    text = page.read_text()
    assert f"Trial {lifted_id}," in text
    assert (tmp_path / "pictures" / "boxes_lifted.png").is_file()
    assert "boxes_dropped.png" not in text


def test_film_strip_has_four_pictures(evaluation_folder: Path, tmp_path: Path) -> None:
    film = next((evaluation_folder / "animations").glob("*.webp"))
    save_film_strip(film, tmp_path / "strip.png")
    with Image.open(tmp_path / "strip.png") as strip:
        assert strip.height == 240
        assert len(MOMENTS) * 320 <= strip.width < (len(MOMENTS) + 1) * 320
    (tmp_path / "broken.webp").write_bytes(film.read_bytes()[:500])
    with pytest.raises(InputError, match="cannot be read"):
        save_film_strip(tmp_path / "broken.webp", tmp_path / "other.png")
    assert not (tmp_path / "other.png").exists()


def test_a_section_is_replaced_and_the_rest_of_the_page_kept(tmp_path: Path) -> None:
    page = tmp_path / "results.md"
    put_section(page, "first", "one \\1 $")
    put_section(page, "second", "two")
    page.write_text(page.read_text() + "\nBy hand.\n")
    before = page.read_text()
    put_section(page, "first", "one \\1 $")
    assert page.read_text() == before
    put_section(page, "first", "three")
    assert page.read_text() == before.replace("one \\1 $", "three")
