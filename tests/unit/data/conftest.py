"""Small synthetic trial tables."""

from collections.abc import Callable

import numpy as np
import pytest

from preshape.data.trial import Face, Trial, TrialOutcome
from preshape.data.trial_table import TableOrigin, TrialTable
from preshape.grasps.space import GraspSpace

TableMaker = Callable[..., TrialTable]


def make_table(n_scenes: int, n_objects: int, success_rate: float = 0.3, seed: int = 0) -> TrialTable:
    """Three executed trials on each scene; the success rate differs between objects."""
    rng = np.random.default_rng(seed)
    rates = np.clip(success_rate * rng.uniform(0.2, 1.8, n_objects), 0, 1)
    trials = []
    for i in range(3 * n_scenes):
        scene_id = i // 3
        lifted = rng.random() < rates[scene_id % n_objects]
        trials.append(
            Trial(
                trial_id=i,
                scene_id=scene_id,
                object_id=f"object_{scene_id % n_objects:02d}",
                planner="heuristic",
                face=list(Face)[i % 3],
                initial=(theta := rng.normal(size=14)),
                planned=theta,
                reached=theta + 1e-3 * rng.normal(size=14),
                outcome=TrialOutcome.LIFTED if lifted else TrialOutcome.MISSED,
                lift_height_m=0.15 * lifted,
                success_prob=float("nan"),
                seed=i,
                scene_s=0.0,
                planning_s=0.0,
                physics_s=0.0,
                rendering_s=0.0,
            )
        )
    space = GraspSpace.palm_and_joints("allegro_palm14", {f"joint_{i}": (-0.5, 0.5) for i in range(8)})
    return TrialTable.from_trials(trials, space, TableOrigin("lbr4_allegro", "synthetic", "synthetic"))


@pytest.fixture(scope="session")
def table() -> TableMaker:
    """`make_table`: a synthetic table of executed trials."""
    return make_table
