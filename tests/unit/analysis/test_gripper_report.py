"""The report of the gripper's experiment says what the trials of its evaluations say, and again the same."""

from pathlib import Path

from synthetic_scenes import allegro_space

from analysis.evaluation_folder import read_evaluation
from analysis.planning.gripper_report import GripperReport
from analysis.planning.runs import of_planner
from preshape.files import read_json


def test_table_and_result_file_count_the_trials(evaluation_folder: Path, tmp_path: Path) -> None:
    page = tmp_path / "results.md"
    page.write_text("# Results\n\nbefore\n\n<!-- begin two_finger -->\n<!-- end two_finger -->\n\nafter\n")
    report = GripperReport(
        conditions={"fitting": str(evaluation_folder)},
        subject="inference",
        output=str(tmp_path / "two_finger.json"),
        page=str(page),
        space=allegro_space(),
    )
    report.write()
    first = page.read_text()
    report.write()
    assert page.read_text() == first
    assert first.startswith("# Results\n\nbefore")
    assert first.endswith("after\n")

    trials = read_evaluation(evaluation_folder, allegro_space()).trials
    for run in read_json(tmp_path / "two_finger.json")["runs"]:
        own = of_planner(trials, run["planner"])
        assert (run["executed"], run["lifted"]) == (len(own.executed), own.lifted.sum())
        row = next(line for line in first.splitlines() if f"| {run['planner'].capitalize()} |" in line)
        assert f"| {run['executed']} | {run['lifted']} |" in row
