"""What is executed to learn from, and how it joins what is known."""

import numpy as np
import pytest
import torch
from synthetic_scenes import ORIGIN, allegro_space, make_scene, make_trial

from preshape.data.joined_tables import DataSet, joined
from preshape.data.trial_table import SceneTable, TrialTable
from preshape.planning.bounds import Bounds
from preshape.planning.objective import Evaluation, Objective
from sim.acquisition import RandomAcquisition, Wanted

INITIAL = np.array([[0.0, 0.0], [2.0, 2.0]])
BOUNDS = Bounds(INITIAL - 1, INITIAL + 1)


class Slope(Objective):
    """Log odds that grow along the first parameter, by a half at 0.3."""

    def evaluate(self, theta: torch.Tensor) -> Evaluation:
        return Evaluation.of(4 * (theta[:, 0] - 0.3), torch.zeros_like(theta[:, 0]))


def acquired(wanted: Wanted, initial: np.ndarray) -> np.ndarray:
    return RandomAcquisition(100, wanted).plan(Slope(), initial, BOUNDS).theta


@pytest.mark.parametrize("wanted", ["any", "uncertain"])
def test_grasps_stay_in_their_boxes_and_follow_from_the_initial_ones(wanted: Wanted) -> None:
    theta = acquired(wanted, INITIAL)
    assert ((theta >= BOUNDS.lower) & (theta <= BOUNDS.upper)).all()
    np.testing.assert_array_equal(theta, acquired(wanted, INITIAL))
    assert not np.array_equal(theta, acquired(wanted, INITIAL + 1e-9))


def test_the_least_sure_grasp_is_wanted_and_keeps_its_probability() -> None:
    result = RandomAcquisition(200, "uncertain").plan(Slope(), INITIAL, BOUNDS)
    assert result.theta[:, 0] == pytest.approx([0.3, 1.0], abs=0.05)
    np.testing.assert_allclose(result.success_prob, 1 / (1 + np.exp(-4 * (result.theta[:, 0] - 0.3))))


def test_an_even_choice_is_not_drawn_to_success() -> None:
    chosen = np.array([acquired("any", INITIAL + 1e-6 * k)[0, 0] for k in range(40)])
    assert abs(chosen.mean()) < 0.3
    assert (np.quantile(chosen, [0.25, 0.75]) * (-1, 1) > 0.2).all()


def data_set(numbers: range) -> DataSet:
    scenes = tuple(make_scene(number) for number in numbers)
    trials = [make_trial(3 * scene.scene_id + i, scene) for scene in scenes for i in range(3)]
    return SceneTable(ORIGIN, scenes), TrialTable.from_trials(trials, allegro_space(), ORIGIN)


def test_joined_data_sets_keep_every_trial_with_its_scene() -> None:
    first, second = data_set(range(4)), data_set(range(2, 7))
    scenes, trials = joined(first, second)
    assert [scene.scene_id for scene in scenes.scenes] == list(range(4)) + [i + 4 for i in range(2, 7)]
    assert trials.rows["trial_id"].is_unique
    seeds = {scene.scene_id: scene.seed for scene in scenes.scenes}
    n = len(first[1])
    np.testing.assert_array_equal(trials.planned[n:], second[1].planned)
    assert trials.rows[:n].equals(first[1].rows)
    assert [seeds[i] for i in trials.scene_ids[n:].tolist()] == second[1].scene_ids.tolist()
