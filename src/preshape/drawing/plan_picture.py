"""All grasps of a plan in one picture."""

import numpy as np
from jaxtyping import UInt8
from matplotlib.figure import Figure

from preshape.drawing.grasp_overlay import grasp_overlay, rectangle_overlay
from preshape.drawing.grasp_window import cut, grasp_window, rectangle_window
from preshape.grasps.rectangle_space import rectangle_of
from preshape.hands.jaws import Jaws
from preshape.hands.kinematics import HandKinematics
from preshape.perception.observation import Observation
from preshape.planning.grasp_plan import GraspPlan

SCALE = 3
"""How many times the picture is larger than the view."""


def plan_picture(observation: Observation, plan: GraspPlan, hand: HandKinematics | Jaws) -> Figure:
    """Figure with one panel per grasp, the best first: before and after planning, and what is predicted.

    Args:
        observation: the view.
        plan: the grasps, palm poses or rectangles.
        hand: kinematics of the hand; rectangles need none.
    """
    starts = plan.result.ranking.tolist()
    figure = Figure(figsize=(6.4 * len(starts), 5.6), layout="constrained")
    panels = figure.subplots(1, len(starts), squeeze=False).flat
    for rank, (axes, start) in enumerate(zip(panels, starts, strict=True), 1):
        axes.imshow(_drawn(observation, plan, hand, start))
        axes.set_axis_off()
        face = "" if plan.jaws else f"{plan.faces[start].value.replace('_', ' ')}: "
        axes.set_title(f"{rank}. {face}{_predicted(plan, start)}", fontsize=15)
    figure.supxlabel("dashed orange: initial grasp; blue: planned grasp", fontsize=13)
    return figure


def _drawn(
    observation: Observation, plan: GraspPlan, hand: HandKinematics | Jaws, start: int
) -> UInt8[np.ndarray, "h w 3"]:
    initial, planned = plan.result.initial_theta, plan.result.theta
    moved = not np.array_equal(initial[start], planned[start])
    if isinstance(hand, Jaws):
        overlay = rectangle_overlay(
            observation.rgb,
            initial=rectangle_of(initial[start]),
            planned=rectangle_of(planned[start]) if moved else None,
            scale=SCALE,
        )
        window = rectangle_window(observation.camera, np.concatenate((initial, planned)))
        return cut(overlay, window, SCALE)
    overlay = grasp_overlay(
        observation.rgb,
        observation.camera,
        hand,
        initial=initial[start],
        planned=planned[start] if moved else None,
        scale=SCALE,
    )
    return cut(overlay, grasp_window(observation.camera, initial), SCALE)


def _predicted(plan: GraspPlan, start: int) -> str:
    before, after = plan.result.initial_success_prob[start], plan.result.success_prob[start]
    if np.isnan(after):
        return "success unknown"
    return f"p(success) {after:.2f}" if before == after else f"p(success) {before:.2f} to {after:.2f}"
