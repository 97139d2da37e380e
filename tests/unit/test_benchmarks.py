"""Benchmarks compare the same work and write the agreed rows; how fast it is depends on the machine."""

import sys
from pathlib import Path

import pytest
from hydra import compose
from omegaconf import DictConfig

from preshape.files import read_json

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def compose_without_workers(command: str, overrides: list[str]) -> DictConfig:
    """So that the views are made at once and not when two processes have imported what they need."""
    return compose(command, [*overrides, "dataset.data.views.maker=null"])


def test_rows_have_the_agreed_keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import collection_speed
    import machine
    import planning_speed
    import rendering_speed
    import run
    import training_speed

    monkeypatch.setattr(collection_speed, "SCENES", 2)
    monkeypatch.setattr(machine, "SIZE", 64)
    monkeypatch.setattr(planning_speed, "ITERATIONS", 1)
    monkeypatch.setattr(planning_speed, "RUNS", 1)
    monkeypatch.setattr(planning_speed, "STARTS", (3,))
    monkeypatch.setattr(rendering_speed, "SCENES", 2)
    monkeypatch.setattr(training_speed, "BATCH", 2)
    monkeypatch.setattr(training_speed, "RUNS", 1)
    monkeypatch.setattr(training_speed, "TRIALS", 100)
    monkeypatch.setattr(training_speed, "compose", compose_without_workers)
    monkeypatch.setattr(sys, "argv", ["run.py", "--output", str(tmp_path / "benchmarks.json")])
    run.main()
    content = read_json(tmp_path / "benchmarks.json")
    assert {"command", "git_revision", "versions", "seed", "date", "machine"} <= set(content)
    for row in content["rows"]:
        assert {"name", "unit", "ours", "peer", "peer_name", "ratio", "bound_share"} <= set(row)
        assert row["ratio"] == pytest.approx(row["peer"] / row["ours"])
        assert row["bound_share"] > 0
