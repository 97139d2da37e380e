"""A prior that looks at the object, fitted to boxes that are held differently as they are tall or flat."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from analytic_objectives import quadratic
from safetensors import safe_open
from safetensors.torch import load_file, save_file
from scipy.spatial.transform import Rotation

from preshape.data.grasp_dataset import GraspBatch
from preshape.errors import InputError
from preshape.files import write_json
from preshape.geometry.pose import make_pose, transform_points
from preshape.grasps.space import GraspSpace
from preshape.perception.view_batch import ViewBatch
from preshape.planning.bounds import Bounds, BoxSize
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch
from preshape.planning.mixture_density_network import METADATA, MixtureDensityNetwork
from preshape.planning.prior import GraspPrior, PriorObjective
from preshape.planning.prior_choice import PriorChoice, read_prior
from preshape.planning.prior_fitting import MixtureFit, NetworkFit

SPACE = GraspSpace.palm_and_joints("test", {f"joint_{k}": (-0.5, 0.5) for k in range(2)})
PLANNER = GradientAscent(LineSearch(0.25, growth=2.0, max_step=1.0), tolerance=1e-5, patience=5)
FIT = NetworkFit(
    components=2, iterations=50, batch_size=32, learning_rate=2e-2, weight_decay=1e-2, check_every=25, seed=0
)
ON_TOP = Rotation.from_euler("y", 90, degrees=True).as_matrix()


def pose(seed: int) -> np.ndarray:
    return make_pose(
        Rotation.random(random_state=seed).as_matrix(), np.random.default_rng(seed).normal(size=3)
    )


def held_at(height_m: float) -> np.ndarray:
    """Where a box is held, seen from its centre: a tall one from the side, a flat one from above."""
    if height_m > 0.1:
        return make_pose(np.eye(3), np.array([-0.1, 0.0, height_m / 4]))
    return make_pose(ON_TOP, np.array([0.0, 0.0, height_m / 2 + 0.08]))


def view_of_box(height_m: float, T_camera_box: np.ndarray, seed: int) -> ViewBatch:
    """Points of a box of 6 cm x 5 cm, wherever it is."""
    rng = np.random.default_rng(seed)
    local = rng.uniform(-0.5, 0.5, (512, 3)) * [0.06, 0.05, height_m]
    parts = (np.zeros((8, 0, 0)), np.ones(4), transform_points(T_camera_box, local), np.ones(4), T_camera_box)
    return ViewBatch(*(torch.tensor(part, dtype=torch.float32)[None] for part in parts))


def grasps(count: int, seed: int) -> GraspBatch:
    """Grasps that lifted boxes of all heights, which lie anywhere."""
    rng = np.random.default_rng(seed)
    views, theta = [], []
    for i in range(count):
        height, box = rng.choice([rng.uniform(0.03, 0.06), rng.uniform(0.16, 0.24)]), pose(1000 * seed + i)
        views.append(view_of_box(height, box, seed=i))
        stray = make_pose(Rotation.from_rotvec(rng.normal(0, 0.02, 3)).as_matrix(), rng.normal(0, 0.002, 3))
        theta.append(SPACE.theta(box @ held_at(height) @ stray, rng.normal(0.2, 0.01, 2)))
    batch = ViewBatch(*(torch.cat(parts) for parts in zip(*views, strict=True)))
    return GraspBatch(batch, torch.tensor(np.stack(theta), dtype=torch.float32), torch.ones(count))


TRAIN, HELD_OUT = grasps(200, seed=1), grasps(40, seed=2)


@pytest.fixture(scope="module")
def network() -> MixtureDensityNetwork:
    return FIT.fitted(TRAIN, HELD_OUT, SPACE)


def log_densities(prior: MixtureDensityNetwork | GraspPrior, given: GraspBatch) -> torch.Tensor:
    """Of each grasp, as a planner has it."""
    each = []
    for i in range(len(given.theta)):
        view = ViewBatch(*(part[i : i + 1] for part in given.view))
        theta = given.theta[i : i + 1].double()
        each.append(prior.in_view(view).log_density(theta, view.T_camera_box.double()))
    return torch.cat(each)


def test_looking_at_the_object_tells_more_than_not_looking(network: MixtureDensityNetwork) -> None:
    mixture = MixtureFit(FIT.components, seed=0).fitted(TRAIN, HELD_OUT, SPACE)
    assert log_densities(network, HELD_OUT).mean() > log_densities(mixture, HELD_OUT).mean() + 0.5


@pytest.mark.parametrize("height_m", [0.04, 0.2])
def test_a_large_weight_leads_to_where_such_objects_are_held(
    network: MixtureDensityNetwork, height_m: float
) -> None:
    box = pose(7)
    mode = SPACE.theta(box @ held_at(height_m), np.full(2, 0.2))
    initial = (mode + np.array([0.02, -0.01, 0.015, 0.05, -0.05, 0.05, -0.2, 0.2]))[None]
    prior = network.in_view(view_of_box(height_m, box, seed=5))
    objective = PriorObjective(quadratic(initial[0], np.ones(8)), prior, box, weight=1e4)
    found = PLANNER.plan(objective, initial, Bounds.around(initial, SPACE, BoxSize())).theta[0]
    np.testing.assert_allclose(found[:3], mode[:3], atol=0.01)
    np.testing.assert_allclose(found[3:], mode[3:], atol=0.05)


def test_moving_camera_or_object_changes_no_density(network: MixtureDensityNetwork) -> None:
    moved, box, palm = pose(3), pose(4), pose(4) @ held_at(0.2)
    here, there = (
        network.in_view(view_of_box(0.2, at, seed=6)).log_density(
            torch.from_numpy(SPACE.theta(hand, np.full(2, 0.1)))[None], torch.from_numpy(at)[None]
        )
        for at, hand in ((box, palm), (moved @ box, moved @ palm))
    )
    torch.testing.assert_close(here, there, rtol=0, atol=1e-3)


def test_the_same_seed_gives_the_same_file_to_the_byte(tmp_path: Path) -> None:
    short = replace(FIT, iterations=12, check_every=6)
    for name, fit in (("one", short), ("again", short), ("other", replace(short, seed=1))):
        torch.rand(1)  # what was drawn elsewhere does not count
        fit.fitted(TRAIN, HELD_OUT, SPACE).write(tmp_path / name)
    one, again, other = ((tmp_path / name).read_bytes() for name in ("one", "again", "other"))
    assert one == again
    assert one != other


def test_the_state_that_suits_the_held_out_grasps_best_is_taken() -> None:
    # The further the variances shrink to those of the training grasps, the less dense it is at these.
    others = HELD_OUT._replace(theta=HELD_OUT.theta + 0.2)
    short = replace(FIT, iterations=25, check_every=5)
    kept, last = (log_densities(short.fitted(TRAIN, judges, SPACE), others) for judges in (others, None))
    assert kept.mean() > last.mean()


def test_a_file_gives_back_the_same_density_and_joins_an_objective(
    network: MixtureDensityNetwork, tmp_path: Path
) -> None:
    path = tmp_path / "prior.safetensors"
    network.write(path)
    again = read_prior(path)
    assert isinstance(again, MixtureDensityNetwork)
    assert torch.equal(log_densities(network, HELD_OUT), log_densities(again, HELD_OUT))
    likelihood, view, box = quadratic(np.zeros(8), np.ones(8)), view_of_box(0.2, pose(0), seed=0), pose(0)
    assert PriorChoice(str(path), 0.0).joined_to(likelihood, SPACE, view, box) is likelihood
    theta = HELD_OUT.theta[:2].double()
    joined = PriorChoice(str(path), 0.5).joined_to(likelihood, SPACE, view, box)
    log_prior = network.in_view(view).log_density(theta, torch.from_numpy(box)[None])
    torch.testing.assert_close(joined(theta), likelihood(theta) + 0.5 * log_prior)
    with pytest.raises(InputError, match="grasp space"):
        PriorChoice(str(path), 0.5).joined_to(likelihood, replace(SPACE, name="other"), view, box)


def test_a_mixture_is_known_by_its_file_whatever_it_is_called(tmp_path: Path) -> None:
    MixtureFit(2, seed=0).fitted(TRAIN, None, SPACE).write(tmp_path / "prior.safetensors")
    assert isinstance(read_prior(tmp_path / "prior.safetensors"), GraspPrior)


def change(path: Path, about: Callable[[str], str] = str, **tensors: torch.Tensor) -> None:
    with safe_open(path, "pt") as file:
        said = file.metadata()[METADATA]
    save_file(load_file(path) | tensors, path, metadata={METADATA: about(said)})


DAMAGES: dict[str, Callable[[Path], object]] = {
    "missing": lambda path: path.unlink(),
    "empty": lambda path: path.write_bytes(b""),
    "truncated": lambda path: path.write_bytes(path.read_bytes()[:-100]),
    "cut in its header": lambda path: path.write_bytes(path.read_bytes()[:50]),
    "weights of something else": lambda path: save_file({"weight": torch.zeros(3)}, path),
    "JSON of something else": lambda path: write_json(path, {"format": "other"}),
    "metadata that are no object": lambda path: change(path, lambda _: "[1]"),
    "of a later version": lambda path: change(path, lambda said: said.replace("network/1", "network/9")),
    "without a grasp space": lambda path: change(path, lambda said: said.replace("grasp_space", "space")),
    "of other sizes": lambda path: change(path, lambda said: said.replace('ents": 2', 'ents": 3')),
    "of a negative size": lambda path: change(path, lambda said: said.replace('ents": 2', 'ents": -2')),
    "of a huge size": lambda path: change(path, lambda said: said.replace('ents": 2', 'ents": 900000000')),
    "of a size that is text": lambda path: change(path, lambda said: said.replace('ents": 2', 'ents": "2"')),
    "in double precision": lambda path: change(
        path, **{"mixture_layer.weight": load_file(path)["mixture_layer.weight"].double()}
    ),
    "with NaN": lambda path: change(path, **{"object_layers.0.bias": torch.full((64,), torch.nan)}),
}


@pytest.mark.parametrize("damage", list(DAMAGES))
def test_what_is_no_prior_is_refused(damage: str, network: MixtureDensityNetwork, tmp_path: Path) -> None:
    path = tmp_path / "prior.safetensors"
    network.write(path)
    DAMAGES[damage](path)
    with pytest.raises(InputError) as refusal:
        read_prior(path)
    assert refusal.value.where == str(path)
