"""The report of the planning experiment says what the trials of its evaluations say."""

from pathlib import Path

import pytest
from PIL import Image
from synthetic_scenes import allegro_space

from analysis.evaluation_folder import read_evaluation
from analysis.paper_figures import ALL, paper_number
from analysis.planning.report import PlanningReport
from analysis.planning.runs import of_planner, outcome_by_scene
from preshape.errors import InputError
from preshape.evaluation.intervals import wilson
from preshape.files import read_json, write_json

KEYS = ("condition", "planner", "n", "executed", "lifted", "rate", "low", "high", "predicted", "seconds")


def report(evaluation: Path, output: Path, **conditions: str) -> PlanningReport:
    return PlanningReport(
        conditions=conditions or {"seen": str(evaluation), "scans": str(output / "missing")},
        subject="inference",
        paper_conditions={"unseen": str(evaluation)},
        paper_subject="inference",
        improvements=[str(output / "missing.json"), str(output / "improvement.json")],
        output=str(output / "planning.json"),
        page=str(output / "results.md"),
        space=allegro_space(),
    )


@pytest.fixture(scope="module")
def written(evaluation_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("report")
    done = {"round": 1, "trials": 60, "added": None, "auc": {"value": 0.9, "low": 0.8, "high": 0.95}}
    planners = read_json(evaluation_folder / "evaluation.json")["planners"]
    rounds = [
        done | {"planners": planners},
        done | {"round": 2, "added": planners["inference"], "planners": planners},
    ]
    write_json(place / "improvement.json", {"acquisition": "uniform", "rounds": rounds})
    assert "heuristic" in report(evaluation_folder, place).write()
    return place


def test_the_report_counts_what_the_trials_say(evaluation_folder: Path, written: Path) -> None:
    content = read_json(written / "planning.json")
    assert list(content)[:5] == ["command", "git_revision", "versions", "seed", "date"]
    evaluation = read_evaluation(evaluation_folder, allegro_space())
    assert [run["planner"] for run in content["runs"]] == ["heuristic", "inference"]
    for run in content["runs"]:
        assert set(KEYS) <= set(run)
        own = of_planner(evaluation.trials, run["planner"])
        assert (run["n"], run["executed"], run["lifted"]) == (2, len(own.executed), own.lifted.sum())
        assert [run["low"], run["high"]] == pytest.approx(wilson(run["lifted"], run["executed"]))
        assert sum(entry["executed"] for entry in run["objects"].values()) == run["executed"]
        assert run["scenes"]["lifted"] <= run["scenes"]["answered"] <= run["n"]
    for name in ("rate", "predicted"):
        assert Image.open(written / "pictures" / f"planning_{name}.png").size[0] > 200
    page = (written / "results.md").read_text(encoding="utf-8")
    assert "62 %" in page
    assert "| scans |" not in page
    assert "| Uniform | 2 | 60 |" in page
    of_paper = content["paper_network"]
    assert [test["difference"] for test in of_paper["tests"]] == [content["tests"][0]["difference"]]
    assert "### With the paper's network" in page
    assert Image.open(written / "pictures" / "planning_paper_network_rate.png").size[0] > 200


def test_pairs_are_scenes_on_which_both_executed_a_grasp(evaluation_folder: Path, written: Path) -> None:
    content = read_json(written / "planning.json")
    trials = read_evaluation(evaluation_folder, allegro_space()).trials
    known = {name: outcome_by_scene(of_planner(trials, name)) for name in ("heuristic", "inference")}
    (test,), (whole,) = content["tests"], content["tests_of_all_scenes"]
    assert (test["planner"], test["against"], whole["n"]) == ("inference", "heuristic", 2)
    assert test["n"] == len(known["heuristic"].keys() & known["inference"].keys())
    lifted = [sum(known[name].values()) for name in ("inference", "heuristic")]
    assert whole["difference"] == pytest.approx((lifted[0] - lifted[1]) / 2)


def test_without_an_evaluation_there_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No condition"):
        report(tmp_path, tmp_path, seen=str(tmp_path / "missing")).write()


def test_the_papers_numbers_are_those_it_prints() -> None:
    assert paper_number("seen", "inference", ALL).rate == pytest.approx(0.62)
    assert paper_number("unseen", "paper", "pringles_bbq").rate == pytest.approx(0.8)
    assert paper_number("unseen", "heuristic", ALL).predicted == pytest.approx(0.34)
    assert paper_number("seen", "max_eval", ALL).predicted is None
    assert paper_number("scans", "inference", ALL).rate is None
    assert paper_number("seen", "cem", ALL).rate is None
