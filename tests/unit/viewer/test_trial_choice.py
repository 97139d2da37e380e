"""Choosing trials of the shipped table."""

import pytest

from preshape.data.tables import read_trials
from preshape.data.trial import TrialOutcome
from preshape.errors import InputError
from preshape.paths import project_root
from preshape.viewer.robot_body import Robot
from preshape.viewer.trial_choice import TrialChoice

TABLE = project_root() / "data" / "allegro_grocery" / "trials.parquet"


@pytest.fixture(scope="module")
def choice(robot: Robot) -> TrialChoice:
    return TrialChoice(read_trials(TABLE, robot.grasp_space))


@pytest.mark.parametrize("object_id", [None, "pringles_bbq"])
def test_objects_and_outcomes_part_the_table(choice: TrialChoice, object_id: str | None) -> None:
    rows = choice.table.rows
    by_outcome = {outcome: choice.rows(object_id, outcome.value) for outcome in TrialOutcome}
    for outcome, chosen in by_outcome.items():
        assert set(rows["outcome"].iloc[chosen]) <= {outcome.value}
        assert object_id is None or set(rows["object_id"].iloc[chosen]) <= {object_id}
    assert sum(map(len, by_outcome.values())) == len(choice.rows(object_id))
    executed = sum(len(chosen) for outcome, chosen in by_outcome.items() if outcome.executed)
    assert len(choice.rows(object_id, "executed")) == executed > 0


def test_a_trial_is_found_by_its_number(choice: TrialChoice) -> None:
    assert choice.table.rows["trial_id"].iloc[choice.row_of(447)] == 447


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda choice: choice.rows("pringle_bbq"), "pringles_bbq"),
        (lambda choice: choice.rows(None, "lift"), "lifted"),
        (lambda choice: choice.row_of(10**9), "no trial 1000000000"),
    ],
)
def test_what_there_is_not_is_refused_with_what_there_is(choice: TrialChoice, ask, message: str) -> None:
    with pytest.raises(InputError, match=message):
        ask(choice)
