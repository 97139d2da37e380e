"""A prior over theta, fitted, kept, and counted as much as it is said to."""

from pathlib import Path

import numpy as np
import pytest
import torch
from analytic_objectives import quadratic
from scipy.spatial.transform import Rotation
from sklearn.mixture import GaussianMixture
from synthetic_views import view_of

from preshape.errors import InputError
from preshape.files import read_json, write_json
from preshape.geometry.pose import make_pose
from preshape.grasps.space import GraspSpace
from preshape.planning.bounds import Bounds, BoxSize
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch
from preshape.planning.prior import MIN_VARIANCE, GraspPrior, PriorObjective, in_box
from preshape.planning.prior_choice import PriorChoice
from preshape.planning.prior_fitting import fit_mixture

SPACE = GraspSpace.palm_and_joints("test", {f"joint_{k}": (-0.5, 0.5) for k in range(2)})
PLANNER = GradientAscent(LineSearch(0.25, growth=2.0, max_step=1.0), tolerance=1e-5, patience=5)


def pose(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return make_pose(Rotation.random(random_state=seed).as_matrix(), rng.normal(size=3))


def grasps(count: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Grasps that scatter about one pose in the frames of boxes that lie anywhere."""
    rng = np.random.default_rng(0)
    boxes = np.stack([pose(seed) for seed in range(count)])
    turns = Rotation.from_rotvec(rng.normal(0, 0.02, (count, 3)))
    local = [make_pose(turn.as_matrix(), rng.normal([0.1, 0.0, 0.05], 0.002)) for turn in turns]
    theta = [
        SPACE.theta(box @ palm, rng.normal(0.2, 0.01, 2)) for box, palm in zip(boxes, local, strict=True)
    ]
    return torch.from_numpy(np.stack(theta)), torch.from_numpy(boxes)


@pytest.fixture(scope="module")
def prior() -> GraspPrior:
    return fit_mixture(*grasps(60), SPACE, components=1, seed=0)


def start(box: np.ndarray) -> tuple[np.ndarray, np.ndarray, Bounds]:
    """An initial grasp near the mode of the prior around a box, the mode itself, and bounds."""
    mode = SPACE.theta(box @ make_pose(np.eye(3), np.array([0.1, 0.0, 0.05])), np.full(2, 0.2))
    initial = (mode + np.array([0.02, -0.01, 0.015, 0.05, -0.05, 0.05, -0.3, 0.2]))[None]
    return initial, mode, Bounds.around(initial, SPACE, BoxSize())


def test_a_large_weight_leads_to_the_mode_of_the_prior_wherever_the_object_is(prior: GraspPrior) -> None:
    for seed in (100, 101):
        box = pose(seed)
        initial, mode, bounds = start(box)
        objective = PriorObjective(quadratic(initial[0], np.ones(8)), prior, box, weight=1e4)
        np.testing.assert_allclose(PLANNER.plan(objective, initial, bounds).theta[0], mode, atol=0.01)


def test_weight_zero_is_the_likelihood(prior: GraspPrior, tmp_path: Path) -> None:
    prior.write(tmp_path / "prior.json")
    likelihood = quadratic(np.zeros(8), np.ones(8))
    choice = PriorChoice(str(tmp_path / "prior.json"), weight=0.0)
    assert (
        choice.joined_to(likelihood, SPACE, view_of(torch.zeros(1, 8, 0, 0), [[1.0] * 4]), pose(0))
        is likelihood
    )
    theta = torch.from_numpy(start(pose(0))[0])
    weightless = PriorObjective(likelihood, prior, pose(0), weight=0.0)
    assert torch.equal(weightless(theta), likelihood(theta))


def test_the_density_is_that_of_scikit_learn_and_differentiable(tmp_path: Path) -> None:
    theta, boxes = grasps(40)
    prior = fit_mixture(theta, boxes, SPACE, components=3, seed=0)
    prior.write(tmp_path / "prior.json")
    again = GraspPrior.read(tmp_path / "prior.json")
    features = in_box(theta, boxes).numpy()
    judge = GaussianMixture(3, reg_covar=MIN_VARIANCE, random_state=0).fit(features)
    constant = prior.log_density(theta, boxes).numpy() - judge.score_samples(features)
    assert constant == pytest.approx(constant[0])
    box, leaf = boxes[:1], theta[:2].clone().requires_grad_()
    assert torch.equal(prior.log_density(leaf, box), again.log_density(leaf, box))
    assert torch.autograd.gradcheck(lambda theta: again.log_density(theta, box), leaf)


def test_what_is_no_prior_is_refused(prior: GraspPrior, tmp_path: Path) -> None:
    path = tmp_path / "prior.json"
    prior.write(path)
    write_json(path, read_json(path) | {"means": [[0.0]]})
    with pytest.raises(InputError, match="damaged"):
        GraspPrior.read(path)
    prior.write(path)
    write_json(path, read_json(path) | {"log_weights": [None]})
    with pytest.raises(InputError, match="damaged"):
        GraspPrior.read(path)
    path.write_text(path.read_text(encoding="utf-8").replace("null", "NaN"), encoding="utf-8")
    with pytest.raises(InputError, match="NaN"):
        GraspPrior.read(path)
    with pytest.raises(InputError, match="no file"):
        PriorChoice(weight=1.0)
    with pytest.raises(InputError, match="cannot make"):
        fit_mixture(*grasps(2), SPACE, components=3, seed=0)
