import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from synthetic_scenes import allegro_space

from analysis.pages.climb_chart import LABEL_SPACING, climb_chart
from preshape.data.trial import Face
from preshape.planning.grasp_plan import GraspPlan
from preshape.planning.result import PlanResult, PlanStatus

probabilities = st.lists(st.floats(0, 1), min_size=1, max_size=130)


def plan_with(*climbs: list[float]) -> GraspPlan:
    starts = len(climbs)
    ends = np.array([climb[-1] for climb in climbs])
    result = PlanResult(
        theta=np.zeros((starts, 14)),
        success_prob=ends,
        log_posterior=ends,
        initial_theta=np.zeros((starts, 14)),
        initial_success_prob=ends,
        initial_log_posterior=ends,
        ranking=np.arange(starts),
        status=(PlanStatus.CONVERGED,) * starts,
        iterations=np.zeros(starts, dtype=int),
        evaluations=0,
        runtime_s=0.0,
        climb=tuple(tuple(climb) for climb in climbs),
        violation_m=np.zeros(starts),
    )
    return GraspPlan("test", allegro_space(), tuple(Face)[:starts], result, np.eye(4), np.eye(4))


@given(st.lists(probabilities, min_size=1, max_size=3))
def test_lines_stay_within_the_axes_and_labels_apart(climbs: list[list[float]]) -> None:
    chart = climb_chart(plan_with(*climbs))
    for line, climb in zip(chart.lines, climbs, strict=True):
        points = np.array([point.split(",") for point in line.points.split()], dtype=float)
        assert len(points) == len(climb)
        assert ((points[:, 0] >= chart.left) & (points[:, 0] <= chart.right)).all()
        assert ((points[:, 1] >= chart.top) & (points[:, 1] <= chart.bottom)).all()
        np.testing.assert_array_equal(np.sign(np.diff(points[:, 1])) * np.sign(np.diff(climb)) <= 0, True)
    labels = sorted(line.label_y for line in chart.lines)
    assert all(np.diff(labels) >= LABEL_SPACING - 1e-9)
    assert labels[-1] <= chart.bottom


@pytest.mark.parametrize("iterations", [0, 1, 7, 30, 100])
def test_ticks_are_few_and_whole(iterations: int) -> None:
    chart = climb_chart(plan_with([0.5] * (iterations + 1)))
    assert 2 <= len(chart.x_ticks) <= 9
    assert all(text.isdigit() for _, text in chart.x_ticks)
