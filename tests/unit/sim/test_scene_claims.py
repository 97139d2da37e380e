"""Whoever finishes the scenes, the same ones are needed, and none is worked on twice."""

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from synthetic_finished_scenes import finished_scene

from preshape.errors import InputError
from sim.finished_scenes import FinishedScene
from sim.scene_claims import SceneClaims

COUNTS = [0, 3, 1, 0, 2, 2, 0, 0, 3, 1, 2, 0]


@dataclass
class Executed:
    wanted: int
    unit: str = "trials"
    note: str = ""

    def count(self, finished: FinishedScene) -> int:
        return sum(trial.outcome.executed for trial in finished.trials)


@contextmanager
def claims_in(folder: Path, wanted: int = 7, block: int = 2) -> Iterator[SceneClaims]:
    claims = SceneClaims(folder, block, len(COUNTS), Executed(wanted))
    yield claims
    claims.close()


def finish(claims: SceneClaims, number: int) -> None:
    claims.add(finished_scene(number, COUNTS[number]))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("block", [1, 2, 5])
def test_the_needed_scenes_do_not_depend_on_who_finishes_when(tmp_path: Path, seed: int, block: int) -> None:
    rng = np.random.default_rng(seed)
    with claims_in(tmp_path, block=block) as one, claims_in(tmp_path, block=block) as other:
        taken: list[int] = []
        working: list[tuple[SceneClaims, int]] = []
        while not (one.complete and other.complete):
            claims = (one, other)[rng.integers(2)]
            if rng.random() < 0.5 and (number := claims.next()) is not None:
                taken.append(number)
                working.append((claims, number))
            elif working:
                finish(*working.pop(int(rng.integers(len(working)))))
            claims.look()
        assert len(taken) == len(set(taken))
        for claims in (one, other):
            assert [finished.scene_id for finished in claims.finished()] == [0, 1, 2, 3, 4, 5]


def test_a_second_start_goes_on_where_the_first_one_ended(tmp_path: Path) -> None:
    with claims_in(tmp_path) as first:
        for _ in range(4):
            number = first.next()
            assert number is not None
            finish(first, number)
        first.next()
    with claims_in(tmp_path) as second:
        assert second.counted == 4
        assert second.next() == 4


def test_a_finished_scene_that_was_damaged_is_reported_and_made_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with claims_in(tmp_path) as claims:
        while not claims.complete:
            number = claims.next()
            assert number is not None
            finish(claims, number)
        at_fault = tmp_path / "scenes_0000002.jsonl"
        at_fault.write_bytes(at_fault.read_bytes().replace(b'"box"', b'"fox"', 1))
        with pytest.raises(InputError, match="Scene 2 was finished"):
            list(claims.finished())
    with claims_in(tmp_path) as claims, caplog.at_level(logging.WARNING):
        assert not claims.complete
        assert claims.next() == 2
        finish(claims, 2)
        assert claims.complete
        assert [finished.scene_id for finished in claims.finished()] == [0, 1, 2, 3, 4, 5]
    (message,) = caplog.messages
    assert str(at_fault) in message
    assert "1 damaged" in message


def test_who_has_a_block_is_named(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with claims_in(tmp_path, block=len(COUNTS)) as one, claims_in(tmp_path, block=len(COUNTS)) as other:
        assert one.next() == 0
        assert other.next() is None
        assert f"Process {os.getpid()} on " in caplog.messages[0]


def test_too_few_trials_exhaust_the_scenes(tmp_path: Path) -> None:
    with claims_in(tmp_path, wanted=100) as claims:
        while (number := claims.next()) is not None:
            finish(claims, number)
        assert claims.exhausted
        assert not claims.complete
