"""Detection: the paper's planner finds a known rectangle from its starts, and what comes out is counted."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch
from hydra.utils import instantiate
from omegaconf import OmegaConf
from torch import Tensor

from preshape.cornell.data_set import CornellImage
from preshape.cornell.detection import Detection, Detector, RectangleGrid
from preshape.cornell.layout import ImageFiles
from preshape.cornell.object_finder import FinderSettings
from preshape.cornell.object_list import Subject
from preshape.cornell.protocols import FoldOutcome, evaluate_folds, result_rows
from preshape.cornell.rectangle import GraspRectangle
from preshape.cornell.rectangle_dataset import LoadedImage
from preshape.cornell.rectangle_metric import angle_between
from preshape.cornell.rectangle_views import RectangleView, RectangleViewSettings
from preshape.cornell.result_file import merge_rows, summary
from preshape.errors import InputError
from preshape.files import read_json
from preshape.grasps.rectangle_space import rectangle_space, theta_of
from preshape.models.success_model import SuccessModel
from preshape.paths import project_root
from preshape.perception.view_batch import ViewBatch
from preshape.planning.rectangle_planner import RectanglePlanner, RectangleStarts

SPACE = rectangle_space("rectangle4")
CENTRE = (300.0, 240.0)
FILES = ImageFiles(100, Path("r.png"), Path("cpos.txt"), Path("cneg.txt"), None, None)


class Peak(SuccessModel):
    """Success is likely at one rectangle, whichever way round its angle is counted."""

    def __init__(self, rectangle: GraspRectangle) -> None:
        super().__init__("peak", "rectangle4", 4)
        self.best = torch.nn.Parameter(torch.from_numpy(theta_of(rectangle)))

    def features(self, view: ViewBatch) -> ViewBatch:
        return view

    def raw_head(self, features: ViewBatch, theta: Tensor) -> Tensor:
        off = theta - self.best
        return (
            3 - (off[:, :2] / 20).square().sum(1) - (off[:, 3] / 20).square() + 2 * torch.cos(2 * off[:, 2])
        )


def make_detector(counts: tuple[int, ...] = (1, 4)) -> Detector:
    cfg = OmegaConf.load(project_root() / "conf" / "planner" / "paper_rectangle.yaml")
    planner = RectanglePlanner(
        name="paper_rectangle",
        method=instantiate(cfg.method),
        box=instantiate(cfg.box),
        space=SPACE,
        starts=RectangleStarts(count=max(counts)),
        views=RectangleViewSettings(step_px=4),
        finder=FinderSettings(),
    )
    grid = RectangleGrid(reach_px=40.0, step_px=20.0, angles=6, openings_px=[25.0, 40.0])
    return Detector(planner, counts, grid, seed=0)


def test_nothing_is_chosen_of_no_rectangle() -> None:
    with pytest.raises(InputError, match="no rectangle"):
        make_detector((0, 4))


def image_with(*positives: GraspRectangle) -> LoadedImage:
    image = CornellImage(FILES, Subject(1, "block", "table"), positives, ())
    nothing = np.zeros((8, 120, 160), np.float16), np.ones(4, np.float32), np.zeros(4, np.float32)
    return LoadedImage(image, RectangleView(*nothing))


@pytest.mark.parametrize("angle", [0.02, 1.5, math.pi - 0.02])
def test_inference_climbs_to_the_rectangle_from_the_papers_starts(angle: float) -> None:
    best = GraspRectangle(318.0, 226.0, angle, 44.0, 25.0)
    found = make_detector().detect(image_with(best), CENTRE, Peak(best))
    by_method = {(own.method, own.starts): own for own in found}
    planned, given = by_method["inference", 4], by_method["max_eval", 4]
    assert planned.correct
    assert 0 <= planned.rectangle.angle_rad < math.pi
    assert angle_between(planned.rectangle, best) < 0.1
    assert planned.success_prob > given.success_prob
    assert (given.rectangle.u, given.rectangle.v) == pytest.approx(CENTRE)
    grid = next(own for own in found if own.method == "grid")
    assert grid.starts == 25 * 6 * 2
    assert grid.correct


def test_more_starts_are_never_worse_and_the_first_ones_stay() -> None:
    best = GraspRectangle(310.0, 250.0, 1.0, 40.0, 25.0)
    found = make_detector((1, 2, 4)).detect(image_with(best), CENTRE, Peak(best))
    for method in ("max_eval", "inference"):
        probs = [own.success_prob for own in found if own.method == method]
        assert probs == sorted(probs)
    few, many = (RectangleStarts(n).around(CENTRE, np.random.default_rng(3)) for n in (2, 64))
    np.testing.assert_array_equal(few, many[:2])
    assert (many[:, 3] == 30).all()


def test_folds_that_were_not_trained_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="10 folds were not trained"):
        evaluate_folds(tmp_path, ["scenes", "unseen"], lambda *_: None, make_detector())


def detection(image: int, method: str, starts: int, correct: bool) -> Detection:
    return Detection(image, method, starts, GraspRectangle(1.0, 2.0, 0.3, 30.0, 25.0), 0.8, correct)


def test_rows_count_both_protocols_and_replace_only_their_own(tmp_path: Path) -> None:
    predictions = pd.DataFrame(
        {"scene_id": [1, 1, 2, 2], "lifted": [True, False, True, False], "success_prob": [0.9, 0.2, 0.6, 0.7]}
    )
    found = [detection(number, "inference", 4, correct=number < 4) for number in range(1, 5)]
    outcomes = [FoldOutcome("unseen", predictions, found), FoldOutcome("scenes", predictions, found[:1])]
    rows = result_rows("cornell", outcomes, seed=0)
    values = {(row["folds"], row["metric"]): row for row in rows}
    assert values["object_wise", "recognition_accuracy"]["value"] == 0.75
    detected = values["object_wise", "detection_inference_4"]
    assert (detected["value"], detected["n"]) == (0.75, 4)
    assert detected["low"] < 0.75 < detected["high"]
    assert values["image_wise", "detection_inference_4"]["n"] == 1
    assert "object-wise detection inference 4 0.750" in summary(rows)

    path = tmp_path / "cornell.json"
    merge_rows(path, [row | {"data": "sim_cornell"} for row in rows], seed=0)
    merge_rows(path, rows, seed=0)
    merge_rows(path, rows, seed=0)
    content = read_json(path)
    assert [row["data"] for row in content["runs"]] == ["sim_cornell"] * len(rows) + ["cornell"] * len(rows)
    assert {"command", "git_revision", "versions", "seed", "date"} <= set(content)
