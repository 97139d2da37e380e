"""The table of a sweep of evaluations: every planner of every run, the best first, and what was swept."""

from pathlib import Path

import pandas as pd
import pytest

from preshape.evaluation.intervals import wilson
from preshape.files import atomic_path, write_json
from preshape.provenance import TYPED_COMMAND
from preshape.sweeps.run_table import join_table, sweep_folder
from sim.planner_table import PlannerTable

SWEPT = "planners.inference.method.max_iterations"
COMMAND = f"python sim/evaluate.py --multirun {SWEPT}=10,100 evaluate.scenes=9"


def summary(lifted: int) -> dict[str, float | None]:
    """Of nine scenes; a planner that lifts nothing has found nothing within reach."""
    executed = 9 if lifted else 0
    low, high = wilson(lifted, executed)
    counts = {"scenes": 9, "answered": executed, "executed": executed, "lifted": lifted}
    return {**counts, "rate": lifted / 9 if lifted else None, "low": low, "high": high, "predicted": None}


def finish_run(runs: Path, iterations: int, lifted: dict[str, int]) -> Path:
    folder = runs / f"palm_points,{iterations}"
    planners = {name: summary(count) for name, count in lifted.items()}
    write_json(folder / "evaluation.json", {"planners": planners})
    with atomic_path(folder / ".hydra" / "overrides.yaml") as temporary:
        temporary.write_text(f"- {SWEPT}={iterations}\n- evaluate.scenes=9\n", encoding="utf-8")
    return folder


def test_the_best_planner_of_all_runs_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(TYPED_COMMAND, COMMAND)
    sweep = sweep_folder(tmp_path, COMMAND)
    for iterations, lifted in ((10, 6), (100, 8), (100, 8)):
        run = finish_run(tmp_path, iterations, {"heuristic": 2, "inference": lifted, "sampling": 0})
        rows, table = join_table(sweep, run, PlannerTable())
    assert pd.read_csv(rows)["lifted"].tolist() == [8, 6, 2, 2, 0, 0]
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.read_text().splitlines()[2:]]
    assert lines[0][:2] == ["max_iterations=100", "inference"]
    assert lines[1][:2] == ["max_iterations=10", "inference"]
    assert lines[0][5] == "0.889 [0.565, 0.980]"
    assert lines[-1][2:] == ["0 of 9", "0", "0", "", ""]
