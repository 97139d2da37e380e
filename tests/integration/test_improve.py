"""`python sim/improve.py` as a user runs it, with little of everything."""

import json
from pathlib import Path

from ready_python import ReadyPython

from preshape.data.tables import read_data_set
from preshape.grasps.space import GraspSpace
from preshape.paths import project_root

LITTLE = (
    *("rounds=2", "acquired_scenes=1", "evaluate.poses_per_object=1", "laboratory.scenes.only=[detergent]"),
    *(
        "dataset.data.trials=60",
        "learning.settings.iterations=4",
        "learning.batch_size=16",
        "trainer.batches_per_epoch=2",
    ),
    *("split=scenes", "model.members=2", "evaluate.workers=1", "dataset.data.views.maker.workers=1"),
    *("~planner@planners.heuristic", "~planner@planners.max_eval"),
)


def test_a_second_round_learns_from_what_the_first_planned(
    ready_python: ReadyPython, tmp_path: Path, allegro_space: GraspSpace
) -> None:
    places = (f"paths.{name}={tmp_path / name}" for name in ("cache", "outputs"))
    done = ready_python.run(project_root() / "sim" / "improve.py", *places, *LITTLE, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "outputs" / "improve" / "planner_optimum"
    first, second = json.loads((folder / "improvement.json").read_text())["rounds"]
    assert first["added"] is None
    assert set(first["planners"]) == {"inference"}

    _, acquired = read_data_set(folder / "round_2" / "acquired", allegro_space)
    assert set(acquired.rows["planner"]) == {"planner_optimum"}
    assert second["added"]["executed"] == len(acquired.executed)
    _, shipped = read_data_set(project_root() / "data" / "allegro_grocery", allegro_space)
    _, extended = read_data_set(folder / "round_2" / "data", allegro_space)
    assert len(extended) == len(shipped) + len(acquired)
    columns = ["object_id", "outcome"]
    assert extended.rows[: len(shipped)][columns].equals(shipped.rows[columns])
    assert (extended.reached[len(shipped) :] == acquired.reached).all(axis=1).sum() == len(acquired.executed)
