"""The planners under conf/planner are what they say."""

from pathlib import Path

import pytest
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from preshape.planning.bounds import BoxSize
from preshape.planning.gradient_ascent import GradientAscent
from preshape.planning.line_search import LineSearch

PLANNERS = Path(__file__).parents[3] / "conf" / "planner"


def preset(name: str) -> DictConfig:
    cfg = OmegaConf.load(PLANNERS / f"{name}.yaml")
    assert isinstance(cfg, DictConfig)
    return cfg


def test_paper_has_the_papers_constants() -> None:
    cfg = preset("paper")
    search = LineSearch(first_step=0.001, max_halvings=10, shrink=0.5, sufficient_increase=0.0, growth=None)
    assert instantiate(cfg.method) == GradientAscent(
        search, climbed="logit", step_unit="raw", max_iterations=100, tolerance=0.0, patience=1
    )
    assert instantiate(cfg.box) == BoxSize(position_m=0.05, rotation_rad=0.157)


def test_inference_is_the_same_class_with_other_settings() -> None:
    method = instantiate(preset("inference").method)
    assert isinstance(method, GradientAscent)
    assert method.line_search.growth is not None
    assert method.step_unit == "half_width"


def test_the_papers_planner_for_rectangles_has_its_constants() -> None:
    method = instantiate(preset("paper_rectangle").method)
    search = LineSearch(first_step=0.05, max_halvings=5, shrink=0.5, sufficient_increase=0.0, growth=None)
    assert method == GradientAscent(
        search, climbed="logit", step_unit="half_width", max_iterations=10, tolerance=0.0, patience=1
    )


@pytest.mark.parametrize(
    "path",
    sorted(path for path in PLANNERS.glob("*.yaml") if "rectangle" not in path.stem),
    ids=lambda path: path.stem,
)
def test_all_planners_have_the_same_box(path: Path) -> None:
    cfg = preset(path.stem)
    assert cfg.name == path.stem
    assert instantiate(cfg.box) == BoxSize()
    assert cfg.needs_model == (cfg.name not in {"heuristic", "regression"})
    # What is published is left as it is; all others keep to the same rules.
    as_published = cfg.name in {"heuristic", "regression", "paper"}
    rules = OmegaConf.to_container(cfg, resolve=False)
    assert isinstance(rules, dict)
    assert rules["constraint"] == (None if as_published else "${robot.clearance}")
